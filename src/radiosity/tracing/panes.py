"""Panes: whether a line goes on through a clear pane that it meets.

Every line has two words, hashed from the bits of its origin and direction in the BVH. Hashed again with the number of the pane's
face they give a number in [0, 1): the line goes on where that is below the transmittance. So what becomes of a line is a function
of the line and the scene alone (contracts 2 and 17). It does not depend on the numbers that made the line, nor on the order in
which lines are traced, and of several panes each decides for itself.

All shadow rays from a sensor to a point lamp, or to a sun whose light is parallel, are the same line. They have one fate, which
would be that of all its light. So shadow rays to lights give numbers of their own as well, which are hashed with the line.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import Device, upload
from ..sampling.numbers.random import philox
from ..scene.model import Scene
from .angles import Angles

WORD = (0x50414E45, 0x53524159)  # the key of both hashes: any two words do
ONE = 2.0**32


@dataclass(frozen=True, eq=False)
class Panes:
    """The panes of a scene on a device, for kernels."""

    scene: Scene
    device: Device

    @cached_property
    def angles(self) -> Angles | None:
        """Tables of panes whose transmittance depends on the angle, where there are any."""
        return Angles.of(self.scene, self.device)

    @cached_property
    def thresholds(self) -> Any:
        """Transmittances times 2^32, (n_faces,) UInt32; 0 for faces that are no panes."""
        assert self.scene.transmittance is not None
        fixed = np.minimum(np.round(self.scene.transmittance * ONE), ONE - 1)
        return upload(self.device.types.UInt32, fixed.astype(np.uint32))

    def words(self, origin, direction, own=()) -> tuple[Any, Any]:
        """Return the two words of each line; called in a kernel.

        Args:
            own: two Floats that tell lines apart which have the same origin and direction.
        """
        UInt32 = self.device.types.UInt32
        bits = [dr.reinterpret_array(UInt32, value) for value in (*origin, *direction, *own)]
        first, second, *_ = philox(bits[:4], bits[4:6])
        if own:
            first, second, *_ = philox([first, second, *bits[6:]], WORD)
        return first, second

    def passed(self, words, face, active, direction, normal):
        """Return which lines go on through the faces that they meet; called in a kernel.

        Args:
            direction: of the lines, of unit length.
            normal: of the faces, of any length.
        """
        UInt32 = self.device.types.UInt32
        drawn = philox([*words, face, UInt32(0)], WORD)[0]
        passed = active & (drawn < dr.gather(UInt32, self.thresholds, face, active))
        if self.angles is None:
            return passed
        cosine = dr.abs(dr.dot(direction, normal)) * dr.rsqrt(dr.squared_norm(normal))
        by_angle, share = self.angles.share(face, cosine, active)
        Float = self.device.types.Float
        return dr.select(by_angle, active & (Float(drawn >> 8) * 2.0**-24 < share), passed)
