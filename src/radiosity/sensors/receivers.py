"""Sensors as the lanes of a gather's lines."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ..algorithms.gather.packets import ESCAPED, LOST, Packets, curve
from ..device.backend import upload
from ..sampling.streams import Purpose, Seed, stream
from ..tracing.faces import COLUMN_BITS
from ..tracing.ray_generation import MASK, Frame
from .clearance import clearance
from .model import Sensors

# Upright planes of a cylindrical sensor in each replicate. The clamped cosine has no odd harmonics above the first, so that an
# odd number of planes errs as twice as many would: by 0.2 % of the light of a point lamp, at most, in one replicate.
PLACES = MASK | MASK << COLUMN_BITS  # bits of a record that are column and row
PLANES = 15


@dataclass(frozen=True, eq=False, kw_only=True)
class Receivers(Packets):
    """The lanes of all replicates: one for each plane on which light falls.

    A cylindrical sensor is `PLANES` upright planes, which are turned together by an angle of each replicate.

    Attributes:
        sensors: the points.
        seed: that the angles follow from.
        faces: (n_sensors,) the face that each sensor lies on, where that is known of all.
    """

    sensors: Sensors
    seed: Seed | int
    faces: np.ndarray | None = None

    @cached_property
    def sensor(self) -> np.ndarray:
        """The sensor of each plane, (receivers,) int64."""
        return np.repeat(np.arange(len(self.sensors)), _planes(self.sensors))

    @cached_property
    def receivers(self) -> int:
        return len(self.sensor)

    def mean_of_planes(self, values: Any) -> Any:
        """Return the means over the planes of each sensor, (planes, ...) to (n_sensors, ...), of an array or a sparse array."""
        from scipy.sparse import csr_array

        if self.receivers == len(self.sensors):
            return values
        share = 1 / np.bincount(self.sensor)[self.sensor]
        return csr_array((share, (self.sensor, np.arange(self.receivers)))) @ values

    @cached_property
    def normals(self) -> np.ndarray:
        """The normals of planes in each replicate, (replicates, receivers, 3) float64."""
        normals = np.tile(self.sensors.normals[self.sensor], (self.replicates, 1, 1))
        upright = np.flatnonzero(self.sensors.cylindrical[self.sensor])
        if len(upright):
            axis = self.sensors.normals[self.sensor[upright]]
            first = np.cross(axis, np.where(np.abs(axis[:, :1]) < 0.5, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
            first /= np.linalg.norm(first, axis=1, keepdims=True)
            second = np.cross(axis, first)
            for replicate in range(self.replicates):
                moved = np.random.Generator(np.random.Philox(stream(self.seed, replicate, Purpose.SENSORS_TURN))).random()
                turns = (np.arange(len(upright)) % PLANES + (replicate + moved) / self.replicates) / PLANES
                angle = 2 * np.pi * turns[:, None]
                normals[replicate, upright] = first * np.cos(angle) + second * np.sin(angle)
        return normals

    @cached_property
    def placed(self) -> np.ndarray:
        """Points of planes in the BVH's coordinates, (receivers, 3) float64."""
        bvh = self.geometry.bvh
        return (self.sensors.points[self.sensor] - bvh.centre) * bvh.scale

    @cached_property
    def order(self) -> np.ndarray:
        order = curve(self.sensors.points[self.sensor], self.sensors.normals[self.sensor])
        return np.append(order, np.repeat(order[-1:], self.width - self.receivers))

    @cached_property
    def place(self) -> np.ndarray:
        """The place of each plane, (receivers,) int64."""
        place = np.empty(self.receivers, np.int64)
        place[self.order[: self.receivers]] = np.arange(self.receivers)
        return place

    def extents(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        points = self.placed[self.order]
        fixed = ~self.sensors.cylindrical[self.sensor][self.order]
        return points, points, np.where(fixed[:, None], self.normals[0][self.order], 0.0)  # none where planes turn

    # ---- on the device ---------------------------------------------------------------------------------------------

    @cached_property
    def place_on_device(self):
        """The number of each patch that a line may hit, (n + 2,) UInt32: values of patches are read in their own order."""
        return upload(self.types.UInt32, np.append(np.arange(self.n), [ESCAPED, LOST]).astype(np.uint32))

    @cached_property
    def read_width(self):
        return dr.opaque(self.types.UInt32, self.n)

    @cached_property
    def _records(self):
        """Records as `Geometry.face_records`, of each replicate's planes, (replicates * receivers * 16,) Float."""
        normals = self.normals.reshape(-1, 3)
        first = np.cross(normals, np.where(np.abs(normals[:, :1]) < 0.5, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]]))
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        points, nothing = np.tile(self.placed, (self.replicates, 1)), np.zeros((len(normals), 6))
        rows = np.concatenate([points, nothing, normals, first, self._clearance(points, normals)[:, None]], axis=1)
        return upload(self.types.Float, rows.astype(np.float32))

    def _clearance(self, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        faces = self.geometry.faces
        if self.faces is None:
            return clearance(faces, points, normals)
        return np.tile(faces.plane_offsets[self.faces[self.sensor]], self.replicates)

    def record(self, patch):
        """Return each plane's number, and a place that moves its numbers: those of pixels are mixed, so noise has no pattern."""
        UInt32 = self.types.UInt32
        if self.faces is None:
            return self.types.Array2u(patch, UInt32(0))
        mixed = (patch ^ (patch >> 16)) * UInt32(0x7FEB352D)
        mixed = (mixed ^ (mixed >> 15)) * UInt32(0x846CA68B)
        return self.types.Array2u(patch, (mixed ^ (mixed >> 16)) & PLACES)

    def stopped(self, record, cosine):
        """Sensors take light from all directions alike."""
        return None

    def frame(self, record):
        frame = Frame.read(self.types, self._records, record[0])
        return frame, lambda u: (self.types.Float(0), self.types.Float(0))

    def read(self):
        _ = self.place_on_device, self._records
        lane, replicate, place, plane = super().read()
        return lane, replicate, place, plane + replicate * dr.opaque(self.types.UInt32, self.receivers)


def planes_of(sensors: Sensors) -> int:
    """Return the number of planes on which the light of sensors falls, in a replicate."""
    return int(_planes(sensors).sum())


def _planes(sensors: Sensors) -> np.ndarray:
    return np.where(sensors.cylindrical, PLANES, 1)
