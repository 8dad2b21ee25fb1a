"""How much of a sun's light receivers get straight: cosines where a ray to a point of its disc is free."""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from ...algorithms.gather.lines import Lines
from ...device.backend import upload
from ...problem.lights.ball import Ball
from ...problem.lights.suns import Suns
from ...scene.lights.sun import DIAMETER
from ...tracing.hits import first_hit
from ...tracing.ray_generation import before


@dataclass(frozen=True, eq=False)
class Sunlight:
    """Rays from receivers to suns.

    Attributes:
        lines: have the receivers, of one replicate, and the numbers of their rays.
        places: (n_places,) int64, the places of receivers that are asked, see `Packets`.
        samples: rays of each receiver to each sun: panes let some of them through.
    """

    lines: Lines
    places: np.ndarray
    samples: int = 1

    def shares(self, towards: np.ndarray, first: int, some: slice = slice(None)) -> np.ndarray:
        """Return what the receivers get of a unit of normal irradiance by each sun, (n_suns, n_places) float32.

        Args:
            towards: (n_suns, 3) unit directions to the suns.
            first: the number of the first sun among all: rays are a function of it, the receiver and the seed.
            some: of the suns, which alone are asked.
        """
        here = towards[some]
        if not len(self.places):
            return np.zeros((len(here), 0), np.float32)
        start = first * self.samples + (some.start or 0)
        found = self._cosines(here, start)
        for number in range(1, self.samples):
            found += self._cosines(here, start + number * len(towards))
        return found / self.samples

    def _cosines(self, towards: np.ndarray, start: int) -> np.ndarray:
        packets = self.lines.packets
        types, n = packets.types, len(towards)
        cap = np.full(n, 2 * np.sin(np.radians(DIAMETER) / 4) ** 2)
        suns = Suns(towards, cap, np.ones((n, 1)), Ball.about(packets.geometry.scene))
        suns.prepare(packets.geometry)
        _, replicate, place, patch = packets.read()
        dr.eval(replicate, place, patch)
        width = dr.opaque(types.UInt32, len(self.places))
        ray = dr.arange(types.UInt32, len(self.places) * n)
        sun = ray // width
        lane = dr.gather(types.UInt32, upload(types.UInt32, self.places.astype(np.uint32)), ray - sun * width)
        patch, replicate = dr.gather(types.UInt32, patch, lane), dr.gather(types.UInt32, replicate, lane)
        record = packets.record(patch)
        numbers = self.lines.numbers
        points = numbers.points_of(numbers.keys[0], replicate, record, patch, dr.opaque(types.UInt32, start), start + n + 1)
        frame, position_of = packets.frame(record)
        normal, u = frame.normal * frame.side, points(sun)
        s, t = position_of(u)
        direction = suns.towards_of(sun, u[0], u[1])
        cosine = dr.dot(direction, normal)
        origin = before(frame.origin + frame.first * s + frame.second * t, normal, frame.offset)
        up = cosine > 0
        hit = first_hit(packets.geometry, origin, direction, active=up, own=(u[2], u[3]))
        brought = dr.select(up & ~hit.valid, cosine, 0)
        dr.eval(brought)
        return np.array(brought).reshape(n, len(self.places))
