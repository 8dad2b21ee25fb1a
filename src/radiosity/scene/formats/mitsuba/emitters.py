"""Emitters of a Mitsuba scene that are no surfaces: points, spots, directional ones, and the surroundings.

A spot shines along the z axis of its transformation; between ``beam_width`` and ``cutoff_angle`` it is weakened in proportion to
the angle. All are radiometric, as the rest of the file.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ....errors import SceneError, shown
from ...assemble import warn
from ...lights import webs
from ...lights.frames import frame
from ...lights.luminaire import Luminaire
from ...lights.model import Lights
from ...lights.sky import Sky
from ...lights.sun import Sun
from ..names import numbered
from .color import Colors, equal_energy_rgb
from .environment import sky_of_image
from .node import Node, Spectrum
from .placement import transformation

Light = Luminaire | Sun | Sky
ROWS = 4  # of a sky that is the same everywhere


@dataclass(frozen=True)
class _Found:
    """An emitter: its values by band, whether they are the same at all wavelengths, and what makes the light of them."""

    values: np.ndarray
    flat: bool
    make: Callable[[np.ndarray], Light]


class Emitters:
    """A reader that collects the emitters of a file."""

    def __init__(self, colors: Colors, source: str):
        self._colors, self._source = colors, source
        self._names: dict[str, int] = {}
        self._found: list[_Found] = []
        self._textured: list[str] = []
        self._makers = {
            "point": self._point,
            "spot": self._spot,
            "directional": self._directional,
            "constant": self._constant,
            "envmap": self._environment,
        }

    def add(self, node: Node) -> bool:
        """Add an emitter; return whether its kind is read.

        Raises:
            SceneError: its numbers make no light.
        """
        if node.plugin in self._makers:
            self._makers[node.plugin](node, numbered(node.name or node.plugin, self._names))
        return node.plugin in self._makers

    def finished(self, n_bands: int) -> Lights:
        """Return the lights, for surfaces of so many bands; one warning names what is left out of them.

        Raises:
            SceneError: there are two environments.
        """
        if self._textured:
            warn(f"{self._source}: textures of spots are left out: {shown(self._textured)}")
        in_color = n_bands == 3 or any(one.values.shape[-1] == 3 for one in self._found)
        lights = []
        for one in self._found:
            values = one.values * equal_energy_rgb() if one.flat and in_color else one.values
            if values.any():
                lights.append(one.make(values))
        skies = [one for one in lights if isinstance(one, Sky)]
        if len(skies) > 1:
            names = shown([sky.name for sky in skies])
            raise SceneError(f"{self._source}: has several environments, {names}; Mitsuba takes one: leave out the others")
        luminaires = tuple(one for one in lights if isinstance(one, Luminaire))
        return Lights(luminaires, tuple(one for one in lights if isinstance(one, Sun)), skies[0] if skies else None)

    def _add(self, node: Node, key: str, make: Callable[[np.ndarray], Light]) -> None:
        """Add a light that is made of the values of an argument."""
        values = self._colors.get(node, key, 1.0, emission=True)
        if not isinstance(values, tuple):
            raise SceneError(
                f"{node.place}: '{key}' of this '{node.plugin}' must be the same everywhere; give an rgb or a spectrum"
            )
        self._keep(node, np.array(values), isinstance(node.values.get(key), Spectrum) and len(values) == 1, make)

    def _keep(self, node: Node, values: np.ndarray, flat: bool, make: Callable[[np.ndarray], Light]) -> None:
        if not np.isfinite(values).all() or values.min() < 0:
            raise SceneError(f"{node.place}: this '{node.plugin}' sends {np.ravel(values).tolist()[:3]}; it must not be negative")
        self._found.append(_Found(values, flat, make))

    def _point(self, node: Node, name: str) -> None:
        if "position" in node.values:
            place = node.vector("position", (0.0, 0.0, 0.0))
        else:
            place = transformation(node, name)[:3, 3]
        web, axes = webs.uniform(), frame((0, 0, -1), 0.0, None, name)
        self._add(node, "intensity", lambda v: _luminaire(name, place, axes, web, v))

    def _spot(self, node: Node, name: str) -> None:
        cutoff = node.number("cutoff_angle", 20.0)
        beam = node.number("beam_width", cutoff * 3 / 4)
        if not 0 < cutoff < 180 or not 0 <= beam <= cutoff:
            text = f"cutoff_angle {cutoff:g} and beam_width {beam:g}"
            raise SceneError(
                f"{node.place}: the spot '{name}' has {text}; expected 0 <= beam_width <= cutoff_angle < 180 degrees"
            )
        if node.child("texture") is not None:
            self._textured.append(name)
        matrix, low, width = transformation(node, name), np.radians(cutoff), np.radians(max(cutoff - beam, 1e-9))
        web = webs.cone(beam, cutoff, lambda angle: np.clip((low - angle) / width, 0, 1) if cutoff > beam else angle * 0 + 1, 2)
        axes = frame(matrix[:3, 2], 0.0, None, f"{node.place}: the spot '{name}'")
        self._add(node, "intensity", lambda v: _luminaire(name, matrix[:3, 3], axes, web, v))

    def _directional(self, node: Node, name: str) -> None:
        way = node.vector("direction", (0.0, 0.0, 1.0)) if "direction" in node.values else transformation(node, name)[:3, 2]
        along = frame(way, 0.0, None, f"{node.place}: the emitter '{name}'")[2]
        self._add(node, "irradiance", lambda v: Sun(name, -along, v, 0.0, False))

    def _constant(self, node: Node, name: str) -> None:
        self._add(node, "radiance", lambda v: Sky(name, np.tile(v, (ROWS, 1, 1)), np.eye(3), "constant", False))

    def _environment(self, node: Node, name: str) -> None:
        sky = sky_of_image(node, name, self._colors)
        self._keep(node, sky.radiance, False, lambda v: sky)


def _luminaire(name: str, place: np.ndarray, axes: np.ndarray, web, values: np.ndarray) -> Luminaire:
    """Return a luminaire of so many W/sr."""
    return Luminaire(name, place, axes, web, values * web.flux, np.zeros(3), photometric=False)
