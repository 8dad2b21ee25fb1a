"""The order of lanes: patches along a curve, in packets whose lines are traced together.

The 16 patches of a packet are neighbours, and fire as many lines each. So memory is read in order, and where lines are traced
together (``coherent``), a packet always holds the same lines, whatever the threads, launches or stages.
"""

from dataclasses import dataclass
from functools import cached_property

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...patches.model import Patches
from ...tracing.geometry import Geometry

SIZE = 16
ESCAPED, LOST = 0xFFFFFFFD, 0xFFFFFFFC  # in place of a place: the line hit nothing, or an absorbing back


@dataclass(frozen=True, eq=False)
class Packets:
    """The lanes of all replicates: lane r * width + i is the patch at place i, in replicate r.

    Attributes:
        geometry: the scene on a device.
        replicates: the number of independent runs.
        coherent: trace a packet's lines together.
    """

    geometry: Geometry
    replicates: int
    coherent: bool = False

    @property
    def patches(self) -> Patches:
        return self.geometry.patches

    @property
    def n(self) -> int:
        """The number of patches."""
        return len(self.patches)

    @property
    def count(self) -> int:
        """The number of packets of a replicate."""
        return -(-self.n // SIZE)

    @property
    def width(self) -> int:
        """The number of lanes of a replicate; the last packet may have lanes without a patch."""
        return self.count * SIZE

    @property
    def lanes(self) -> int:
        """The number of lanes of all replicates."""
        return self.width * self.replicates

    @cached_property
    def order(self) -> np.ndarray:
        """The patch of each place, (width,) int64; lanes without a patch repeat the last one."""
        patches = self.patches
        low, high = patches.centroid.min(axis=0), patches.centroid.max(axis=0)
        cells = ((patches.centroid - low) / max((high - low).max(), 1e-300) * 65535).astype(np.uint64)
        x, y, z = (_spread(column) for column in cells.T)
        curve = x | y << np.uint64(1) | z << np.uint64(2)
        facing = np.round(patches.normal * 50).astype(np.int64) + 64
        order = np.lexsort((curve, (facing[:, 0] * 128 + facing[:, 1]) * 128 + facing[:, 2]))
        return np.append(order, np.repeat(order[-1:], self.width - self.n))

    @cached_property
    def place(self) -> np.ndarray:
        """The place of each patch, (n,) int64."""
        place = np.empty(self.n, np.int64)
        place[self.order[: self.n]] = np.arange(self.n)
        return place

    @cached_property
    def sizes(self) -> np.ndarray:
        """The number of patches of each packet, (count,) int64."""
        return np.minimum(self.n - np.arange(self.count) * SIZE, SIZE)

    def by_packet(self, values: np.ndarray) -> np.ndarray:
        """Return the sum over each packet of values of patches, (..., n) to (..., count)."""
        return np.add.reduceat(values[..., self.order[: self.n]], np.arange(self.count) * SIZE, axis=-1)

    def patch_values(self, lanes: np.ndarray) -> np.ndarray:
        """Return values of lanes in the order of patches, (lanes,) to (replicates, n)."""
        return np.asarray(lanes).reshape(self.replicates, self.width)[:, self.place]

    def lane_values(self, values: np.ndarray) -> np.ndarray:
        """Return values of patches in the order of lanes, (replicates, n) to (lanes,)."""
        return values[:, self.order].ravel()

    # ---- on the device ---------------------------------------------------------------------------------------------

    @property
    def types(self):
        return self.geometry.device.types

    @cached_property
    def order_on_device(self):
        """``order``, (width,) UInt32."""
        return upload(self.types.UInt32, self.order.astype(np.uint32))

    @cached_property
    def place_on_device(self):
        """``place``, (n + 2,) UInt32, with `ESCAPED` and `LOST` after it, for lines that hit no patch."""
        return upload(self.types.UInt32, np.append(self.place, [ESCAPED, LOST]).astype(np.uint32))

    @cached_property
    def width_on_device(self):
        """``width``, UInt32."""
        return dr.opaque(self.types.UInt32, self.width)

    def read(self):
        """Return every lane, its replicate, place and patch."""
        _ = self.place_on_device  # kernels read it
        lane = dr.arange(self.types.UInt32, self.lanes)
        replicate = lane // self.width_on_device
        place = lane - replicate * self.width_on_device
        return lane, replicate, place, dr.gather(self.types.UInt32, self.order_on_device, place)

    def of_packets(self, values: np.ndarray, place):
        """Return whole numbers of packets for each lane; lanes without a patch have 0."""
        given = dr.gather(self.types.UInt32, upload(self.types.UInt32, values.astype(np.uint32)), place // SIZE)
        return dr.select(place < dr.opaque(self.types.UInt32, self.n), given, 0)


def _spread(x: np.ndarray) -> np.ndarray:
    """Put two zeros between the bits of 16-bit numbers, which makes places on a Morton curve."""
    for shift, mask in ((16, 0xFF0000FF), (8, 0xF00F00F00F), (4, 0xC30C30C30C3), (2, 0x249249249249)):
        x = (x | x << np.uint64(shift)) & np.uint64(mask)
    return x
