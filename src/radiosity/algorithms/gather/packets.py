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
from ...tracing.ray_generation import BACK, Frame, position

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
    def receivers(self) -> int:
        """The number of lanes of a replicate that fire lines: the patches."""
        return self.n

    @property
    def count(self) -> int:
        """The number of packets of a replicate."""
        return -(-self.receivers // SIZE)

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
        order = curve(self.patches.centroid, self.patches.normal)
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
        return np.minimum(self.receivers - np.arange(self.count) * SIZE, SIZE)

    def by_packet(self, values: np.ndarray) -> np.ndarray:
        """Return the sum over each packet of values of patches, (..., n) to (..., count)."""
        return np.add.reduceat(values[..., self.order[: self.receivers]], np.arange(self.count) * SIZE, axis=-1)

    def patch_values(self, lanes: np.ndarray) -> np.ndarray:
        """Return values of lanes in the order of patches, (lanes,) to (replicates, n)."""
        return np.asarray(lanes).reshape(self.replicates, self.width)[:, self.place]

    def lane_values(self, values: np.ndarray) -> np.ndarray:
        """Return values of patches in the order of lanes, (replicates, n) to (lanes,)."""
        return values[:, self.order].ravel()

    def extents(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return lowest and highest coordinates of each lane's receiver, in the BVH's units, and its normal, (width, 3) each."""
        geometry, patches, order = self.geometry, self.patches, self.order
        corners, face = geometry.faces.corners, patches.face[order]
        low, high = corners.min(axis=1)[face], corners.max(axis=1)[face]
        if not geometry.whole_faces:  # a cell is near its centroid, and within its face
            _, first, second = geometry.faces.frames
            reach = np.linalg.norm(first, axis=1) / patches.columns + np.linalg.norm(second, axis=1) / patches.rows
            centre = (patches.centroid[order] - geometry.bvh.centre) * geometry.bvh.scale
            low, high = np.maximum(low, centre - reach[face, None]), np.minimum(high, centre + reach[face, None])
        return low, high, patches.normal[order]

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

    @property
    def read_width(self):
        """How far apart the values of two replicates lie in what lines read, UInt32."""
        return self.width_on_device

    def record(self, patch):
        """Return the two words of patches, see `Geometry.patch_records`; called in a kernel."""
        return dr.gather(self.types.Array2u, self.geometry.patch_records, patch)

    def stopped(self, record, cosine):
        """Return how much more light patches take from directions than of diffuse light (`tracing.angles`); None: equally much.

        It is called in a kernel.
        """
        panes = self.geometry.panes
        if panes is None or panes.angles is None:
            return None
        return panes.angles.stopped(record[0] & (BACK - 1), cosine)

    def frame(self, record):
        """Return the frame of patches' faces, and a function from numbers to a place on them; called in a kernel."""
        geometry, (face, place) = self.geometry, record
        return Frame.of(geometry, face), lambda u: position(geometry, place, u[2], u[3])

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
        return dr.select(place < dr.opaque(self.types.UInt32, self.receivers), given, 0)


def curve(points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return the order of points, (n,) int64, by direction and then along a Morton curve, from (n, 3) each."""
    low, high = points.min(axis=0), points.max(axis=0)
    cells = ((points - low) / max((high - low).max(), 1e-300) * 65535).astype(np.uint64)
    x, y, z = (_spread(column) for column in cells.T)
    along = x | y << np.uint64(1) | z << np.uint64(2)
    facing = np.round(normals * 50).astype(np.int64) + 64
    return np.lexsort((along, (facing[:, 0] * 128 + facing[:, 1]) * 128 + facing[:, 2]))


def _spread(x: np.ndarray) -> np.ndarray:
    """Put two zeros between the bits of 16-bit numbers, which makes places on a Morton curve."""
    for shift, mask in ((16, 0xFF0000FF), (8, 0xF00F00F00F), (4, 0xC30C30C30C3), (2, 0x249249249249)):
        x = (x | x << np.uint64(shift)) & np.uint64(mask)
    return x
