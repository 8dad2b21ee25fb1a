"""Array-RQMC: particles are sorted between two hits, and take the points of a sequence in that order (P. L'Ecuyer, C. Lecot and
B. Tuffin, "A randomized quasi-Monte Carlo simulation method for Markov chains", Operations Research 56(4), 2008).

The state of a particle of the continuous equation is a place on a face. Particles are sorted by face and, on it, along a Hilbert
curve, so that neighbours in the order are neighbours in the scene. Particle k of the order takes point k of a sequence for its
direction. Which particles go on is systematic: the sum of the chances to survive, from the first particle of the order on, is
cut at every whole number plus a random part, and a particle goes on where its own part holds a cut. So of any stretch of the
order as many go on as its chances say, but for one.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...sampling.blocks import BLOCK
from ...tracing.geometry import Geometry
from ...tracing.lanes import Batch, Launch, chunk
from ...tracing.line_tracer import LineTracer
from ...tracing.ray_generation import BACK

KEY_BITS, CURVE_BITS = 64, 16  # of a key, and at most of one coordinate on a face
FEW = 256  # particles of a replicate: so few and fewer go on in no order, in one kernel


@dataclass(frozen=True)
class Array:
    """A launch whose particles are sorted together: of one replicate.

    Attributes:
        replicate: UInt32, its number.
        block, before: UInt32, upper and lower half of the number of walks of the replicate that began before those of the launch:
            its points begin behind as many.
    """

    launch: Launch
    replicate: Any
    block: Any
    before: Any


def ranges(tracer: LineTracer, batch: Batch, limit: int) -> list[tuple[int, int, int, int]]:
    """Return the arrays of walks that begin together: replicate, walks of it in arrays before, first lane, and last one.

    Args:
        limit: most walks of an array, which has no more than a chunk, whatever the number of threads.
    """
    each = np.bincount(frozen(batch.numbers) // tracer.n, frozen(batch.lanes), tracer.replicates).astype(np.int64)
    ends, most = np.cumsum(each).tolist(), min(chunk(tracer.types), limit)
    return [
        (replicate, first - begin, first, min(first + most, end))
        for replicate, (begin, end) in enumerate(zip([0, *ends[:-1]], ends, strict=True))
        for first in range(begin, end, most)
    ]


def arrays(tracer: LineTracer, batch: Batch, walks: np.ndarray, done: int, limit: int) -> Iterator[tuple[Array, int]]:
    """Yield the arrays of walks that begin together, and the number of those done with each.

    Args:
        walks: (replicates,) walks of earlier stages.
        done: arrays that were done before.
        limit: see `ranges`.
    """
    UInt32 = tracer.types.UInt32
    for at, (replicate, passed, first, end) in enumerate(ranges(tracer, batch, limit)[done:], done + 1):
        block, before = divmod(int(walks[replicate]) + passed, BLOCK)
        (launch,) = batch.launches(tracer.types, first, end, limit)
        yield Array(launch, *(dr.opaque(UInt32, value) for value in (replicate, block, before))), at


def order(geometry: Geometry, place: tuple, on, size: int):
    """Return the order of particles, UInt32: those that are ``on``, by place; then the others.

    Keys hold the particle's number in their last bits. So no two are equal, and any sort gives the same order.

    Args:
        place: face, s and t of `hits.place_of`.
        size: the number of particles.
    """
    types = geometry.device.types
    lanes = max(size - 1, 1).bit_length()
    faces = (2 * geometry.patches.scene.n_faces + 1).bit_length()
    bits = min(CURVE_BITS, (KEY_BITS - lanes - faces) // 2)
    cells = int(max(geometry.patches.columns.max(), geometry.patches.rows.max()))
    face, s, t = place
    scale = dr.opaque(types.Float, float(1 << max(bits - (cells - 1).bit_length(), 0)))
    x, y = (dr.minimum(types.UInt32(dr.maximum(value, 0) * scale), (1 << bits) - 1) for value in (s, t))
    side = dr.select(on, ((face & (BACK - 1)) << 1) | (face >> 31), types.UInt32(2 * geometry.patches.scene.n_faces))
    key = (types.UInt64(side) << (2 * bits)) | types.UInt64(curve(x, y, bits))
    lane = types.UInt64(dr.arange(types.UInt32, size))
    keys = np.sort(frozen((key << lanes) | lane))
    return upload(types.UInt32, (keys & np.uint64((1 << lanes) - 1)).astype(np.uint32))


def curve(x, y, bits: int):
    """Return the number of a cell of a square grid along Hilbert's curve (D. Hilbert, Mathematische Annalen 38, 1891).

    Args:
        x, y: UInt32 below 2^bits.
    """
    number = type(x)(0)
    for bit in reversed(range(bits)):
        right, up = (x >> bit) & 1, (y >> bit) & 1
        number = (number << 2) | ((3 * right) ^ up)
        # the quarter below is walked turned, so that its end touches the next quarter
        low, flipped = up == 0, (up == 0) & (right == 1)
        x, y = dr.select(flipped, ~x, x), dr.select(flipped, ~y, y)
        x, y = dr.select(low, y, x), dr.select(low, x, y)
    return number


def cuts(types, chances, part):
    """Return a number in [0, 1) for each particle of an order, below its chance where its part of the sum of chances holds a cut.

    Args:
        types: Dr.Jit's array types.
        chances: Float, of each particle.
        part: UInt32, where the cuts lie, times 2^32.
    """
    begins = dr.prefix_sum(types.UInt64(chances * 2.0**32))
    return types.Float((part - types.UInt32(begins & 0xFFFFFFFF)) >> 8) * 2.0**-24
