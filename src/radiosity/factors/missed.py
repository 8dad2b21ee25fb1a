"""Shares of light that reach no patch: they leave the scene or end on absorbing backs. Local lines find them."""

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..device.turn import turn
from ..sampling.numbers import ready
from ..sampling.streams import Purpose, stream
from ..tracing.geometry import Geometry
from ..tracing.hits import first_hit, local_line, patch_of
from ..tracing.lanes import CHUNK
from ..tracing.ray_generation import place_number


@turn()
def missed(geometry: Geometry, lines: int = 1024, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Return shares escaped and lost, (n_patches,) float64 each; they are exactly zero where no line escapes or is absorbed.

    Args:
        lines: lines of each patch, 1 to 65 535: points of the Sobol' sequence, with a digital shift for each patch.
    """
    types, n = geometry.device.types, len(geometry.patches)
    UInt32, size = types.UInt32, max(CHUNK // lines, 1)
    numbers = ready("sobol", types)
    shift = upload(UInt32, numbers.randomisation(stream(seed, 0, Purpose.VISIBILITY)))
    geometry.prepare()
    counts = np.zeros((2, n))
    for begin in range(0, n, size):
        count = min(size, n - begin)
        lane = dr.arange(UInt32, max(count * lines, 2))  # arrays of one entry would compile kernels of their own
        row = dr.minimum(lane // dr.opaque(UInt32, lines), dr.opaque(UInt32, count - 1))
        patch = row + dr.opaque(UInt32, begin)
        index = lane - row * dr.opaque(UInt32, lines) + 1
        words = [dr.gather(UInt32, shift, UInt32(i)) for i in range(8)]
        record = dr.gather(types.Array2u, geometry.patch_records, patch)
        points = numbers.points(index, patch, numbers.of_patch(words, place_number(record)), 16)
        patches = patch_of(geometry, first_hit(geometry, *local_line(geometry, record, points)), n + 1, n)
        dr.eval(patches)
        found = np.array(patches)[: count * lines].reshape(count, lines)
        for code in (0, 1):
            counts[code, begin : begin + count] = (found == n + code).sum(axis=1)
    return counts[0] / lines, counts[1] / lines
