"""Luminaires: light leaves a point, or a small area, as a web of intensities says."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...sampling.hemisphere import turn
from ...scene.lights.luminaire import Luminaire
from ...scene.lights.web import Web
from ...scene.precision import OFFSET
from .base import AbstractPointLights
from .web_tables import WebTables

NEAREST = 1e-12  # square of a distance, in the BVH's units: nearer points count as this far away


@dataclass(eq=False)
class Luminaires(AbstractPointLights):
    """The luminaires of a scene. Those that share a web share its table.

    Attributes:
        luminaires: the values.
        n_bands: of the scene.
    """

    luminaires: tuple[Luminaire, ...]
    n_bands: int
    _tables: Any = field(default=None, init=False)
    _heads: Any = field(default=None, init=False)  # that of each luminaire's web
    _frames: Any = field(default=None, init=False)  # 16 floats a luminaire, see `_words`
    _types: Any = field(default=None, init=False)

    @cached_property
    def power(self) -> np.ndarray:
        return np.array([np.broadcast_to(one.power, self.n_bands) for one in self.luminaires], np.float64)

    @cached_property
    def any_soft(self) -> bool:
        """True where the light of some leaves from an area."""
        return any(one.soft for one in self.luminaires)

    def prepare(self, geometry: Any) -> None:
        self._types = types = geometry.device.types
        webs, number = _distinct([one.web for one in self.luminaires])
        self._tables = WebTables(webs)
        self._tables.prepare(types)
        self._heads = upload(types.UInt32, self._tables.heads[number])
        frames = np.array([_words(one, geometry.bvh) for one in self.luminaires])
        self._frames = upload(types.Float, frames.astype(np.float32))

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        frame, head = self._of(light)
        plane, gamma = self._tables.draw(head, numbers[0], numbers[1])
        y, x = dr.sincos(plane)
        sine, cosine = dr.sincos(gamma)
        direction = frame.first * (x * sine) + frame.second * (y * sine) + frame.axis * cosine
        return self._origin(frame, numbers[2:]), dr.normalize(direction)

    def arrive(self, light: Any, point: Any, numbers: Any) -> tuple[Any, Any, Any]:
        frame, head = self._of(light)
        way = self._origin(frame, numbers) - point
        square = dr.maximum(dr.squared_norm(way), NEAREST)
        direction = way * dr.rsqrt(square)
        x, y, z = (-dr.dot(direction, axis) for axis in (frame.first, frame.second, frame.axis))
        plane = dr.atan2(y, x)
        plane = dr.select(plane < 0, plane + 2 * dr.pi, plane)
        share = self._tables.share(head, plane, dr.atan2(dr.sqrt(x * x + y * y), z))
        return direction, dr.sqrt(square), share / square

    def _of(self, light: Any) -> tuple["_Frame", Any]:
        """Return the frame of a luminaire and the head of its web."""
        block = dr.gather(self._types.Array44f, self._frames, light)
        vectors = [self._types.Array3f(row[0], row[1], row[2]) for row in (block[i] for i in range(4))]
        return _Frame(*vectors, *(block[i][3] for i in range(3))), dr.gather(self._types.Array4u, self._heads, light)

    def _origin(self, frame: "_Frame", numbers: Any) -> Any:
        """Return a point of the luminous area, uniform over it; its middle where it is none."""
        if not self.any_soft:
            return frame.place
        x, y = turn(numbers[0])
        radius, disc = dr.sqrt(numbers[1]), frame.disc != 0
        u, v = dr.select(disc, x * radius, 2 * numbers[0] - 1), dr.select(disc, y * radius, 2 * numbers[1] - 1)
        return frame.place + frame.first * (u * frame.length / 2) + frame.second * (v * frame.width / 2)


@dataclass(frozen=True)
class _Frame:
    """A luminaire in a kernel: its place, the directions of C = 0, of C = 90 and of gamma = 0, and its luminous area."""

    place: Any
    first: Any
    second: Any
    axis: Any
    length: Any
    width: Any
    disc: Any


def _words(one: Luminaire, bvh: Any) -> np.ndarray:
    """Return the four rows of a `_Frame`. It stands a few ulps in front of where it is said to be: it may be let into a face."""
    place = (one.position - bvh.centre) * bvh.scale
    length, width = one.size[:2] * bvh.scale if one.soft else (0.0, 0.0)
    place = place + one.axes[2] * OFFSET * max(np.abs(place).max() + length + width, 1.0)
    return np.column_stack([[place, *one.axes], [length, width, one.disc, 0]])


def _distinct(webs: list[Web]) -> tuple[tuple[Web, ...], list[int]]:
    """Return the different ones of webs, and the number of each among them."""
    each = {id(web): web for web in webs}  # most share one by themselves
    known: dict[tuple, int] = {}
    number = {}
    for name, web in each.items():
        key = tuple((x.shape, x.tobytes()) for x in (web.planes, web.gamma, web.intensity))
        number[name] = known.setdefault(key, len(known))
    first = {number[name]: web for name, web in reversed(each.items())}
    return tuple(first[i] for i in range(len(first))), [number[id(web)] for web in webs]
