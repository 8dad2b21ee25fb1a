"""An order of lines in which neighbours are near each other: they touch the same parts of the BVH, and trace faster.

The order changes no result: every line is traced by itself. It costs no sorting: Halton indices with equal remainders modulo
powers of the bases lie in one box of the cube (see `sampling.numbers.strata`), and lines go box by box.
"""

from functools import cache

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...sampling.numbers.halton import BASES

DIGITS = {  # of the index in each base: boxes of begin and end; of direction and place; of the side that lines leave
    "global": (3, 3, 1, 1, 0),
    "global-disc": (3, 2, 2, 1, 0),
    "spans": (0, 0, 0, 0, 3),
    "bundles": (0, 0, 0, 0, 0),
}
LEAST = 16  # lines of a box: a packet


def ordered(types, kind: str, numbers: str, begin, count: int):
    """Return a permutation of the lanes 0 to ``count`` - 1, UInt32, in which like lines follow each other.

    Lane 0 has the line of index ``begin`` (UInt32, opaque). Where there are no boxes, the lanes stay in their order.
    """
    lane = dr.arange(types.UInt32, max(count, 2))
    n = _boxes(kind)
    if numbers != "halton" or n == 1 or count < LEAST * n:
        return lane
    cycles = dr.opaque(types.UInt32, count // n)
    box = lane // cycles
    whole = box < n
    offset = dr.gather(types.UInt32, _walk(types.UInt32, kind), box, whole) + n - begin % n
    offset = dr.select(offset >= n, offset - n, offset)
    # what is left of a last, incomplete cycle keeps its order
    return dr.select(whole, offset + (lane - box * cycles) * n, lane)


def _boxes(kind: str) -> int:
    return int(np.prod([base**k for base, k in zip(BASES, DIGITS[kind], strict=True)]))


@cache
def _walk(UInt32, kind: str):
    """Return remainders in the order of their boxes, on the device."""
    remainder, keys = np.arange(_boxes(kind)), []
    for base, digits in zip(BASES, DIGITS[kind], strict=True):
        value, mirrored = remainder.copy(), np.zeros_like(remainder)
        for _ in range(digits):
            mirrored, value = mirrored * base + value % base, value // base
        keys.append(mirrored)
    return upload(UInt32, np.lexsort(keys[::-1]).astype(np.uint32))
