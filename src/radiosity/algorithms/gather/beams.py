"""Lights without area as targets of shadow rays: luminaires and suns."""

from dataclasses import dataclass
from functools import cached_property

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...problem.lights.together import AllLights
from ...problem.model import Problem
from ...tracing.geometry import Geometry
from .boxes import Boxes

MIDDLE = [(0, 0, 0)] * 5
CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)] + MIDDLE, float)  # points of a box
NUMBERS = np.array([(0.5, 0.5)] * 9 + [(0, 0), (0, 1), (1, 0), (1, 1)], np.float32)  # where on the light
PIECE = 1 << 20  # points and lights at a time
NEAREST = 0.25  # of a box's radius: how near to a point of it a light counts at most
BEHIND = -0.1  # cosine: a light is behind a plane where it is below that at all points of the box


@dataclass(frozen=True, eq=False)
class Beams:
    """The light that luminaires and suns send to points.

    Attributes:
        lights: those that shadow rays can go to.
        geometry: the scene on a device.
        problem: whose rows they are.
    """

    lights: AllLights
    geometry: Geometry
    problem: Problem

    @staticmethod
    def of(geometry: Geometry, problem: Problem) -> "Beams | None":
        """Return those of a problem; None where there are none."""
        lights = None if problem.lights is None else problem.lights.points
        return None if lights is None else Beams(lights, geometry, problem)

    def __len__(self) -> int:
        return len(self.lights.power)

    @cached_property
    def power(self) -> np.ndarray:
        """The power of each light, (n_lights, n_groups) float64, in units of `Problem.unit`: what a share of 1 / (BVH's unit)²
        brings."""
        n, problem = len(self), self.problem
        power = problem.rows.emission[problem.rows.n_patches :][:n]
        return power * self.geometry.bvh.scale**2 / np.maximum(problem.unit, 1e-300)

    def weights(self, boxes: Boxes) -> np.ndarray:
        """Return about the irradiance by each light at each cluster where nothing is between, (k, n_lights) float64, in shares of
        the unit; zero where no light can arrive."""
        clusters, n = len(boxes.middle), len(self)
        points = boxes.middle[:, None] + boxes.half[:, None] * CORNERS
        nearest = NEAREST * np.linalg.norm(boxes.half, axis=1) + 1e-9
        found = np.empty((clusters, n))
        largest = self.power.max(axis=1)
        step = max(PIECE // (n * len(CORNERS)), 1)
        for at in range(0, clusters, step):
            rows = slice(at, at + step)
            cosine, distance, share = self._arrive(points[rows], boxes.normal[rows])
            share = share * np.minimum(distance / nearest[rows, None, None], 1.0) ** 2
            plane = boxes.lean[rows] > 1 - 1e-9
            behind = plane[:, None] & (cosine.max(axis=1) < BEHIND)
            facing = np.where(plane[:, None, None], np.clip(cosine, 0.02, 1), 1.0)
            found[rows] = np.where(behind, 0.0, (facing * share).mean(axis=1) + 1e-3 * share.max(axis=1)) * largest
        return found

    def _arrive(self, points: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return cosines to the normals, distances and shares of the light of all lights, (k, points, n_lights) each."""
        _ = self._ready
        types = self.geometry.device.types
        k, each, n = len(points), len(CORNERS), len(self)
        shape = (k, each, n)
        columns = [np.broadcast_to(points[:, :, None, i], shape).astype(np.float32) for i in range(3)]
        point = types.Array3f(*(upload(types.Float, column) for column in columns))
        numbers = [upload(types.Float, np.broadcast_to(NUMBERS[None, :, None, i], shape)) for i in (0, 1)]
        light = upload(types.UInt32, np.broadcast_to(np.arange(n, dtype=np.uint32), shape))
        direction, distance, share = self.lights.arrive(light, point, numbers)
        dr.eval(direction, distance, share)
        towards = np.stack([np.array(direction[i]) for i in range(3)], axis=-1).reshape(*shape, 3)
        cosine = np.einsum("kpli,ki->kpl", towards, normals)
        distance = np.broadcast_to(np.array(distance, np.float64), k * each * n).reshape(shape)
        return cosine, distance, np.broadcast_to(np.array(share, np.float64), k * each * n).reshape(shape)

    # ---- on the device ---------------------------------------------------------------------------------------------

    def prepare(self) -> None:
        """Make what kernels read."""
        _ = self._ready, self.powers

    @cached_property
    def _ready(self) -> bool:
        """The lights are on the device; a solution that is read asks for weights before any line."""
        self.lights.prepare(self.geometry)
        return True

    @cached_property
    def powers(self) -> list:
        """The columns of ``power``, Float of each group."""
        return [upload(self.geometry.device.types.Float, column.astype(np.float32)) for column in self.power.T]
