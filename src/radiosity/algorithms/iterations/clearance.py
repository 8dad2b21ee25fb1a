"""The clearance of patches: how far away what they see is, by a few local lines of each; and the elements that are clear.

It is the harmonic mean of the lengths of the lines, which bounds how fast irradiance may change along a surface (G. Ward,
F. Rubinstein, R. Clear, "A ray tracing solution for diffuse interreflection", SIGGRAPH 1988). It is a property of the scene and
of how it is cut: no seed changes it.
"""

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...patches import Hierarchy
from ...sampling.numbers import ready
from ...sampling.streams import Purpose, stream
from ...tracing.geometry import Geometry
from ...tracing.hits import first_hit, local_line
from ...tracing.lanes import CHUNK
from ...tracing.ray_generation import place_number

LINES = 16  # of each patch


def largest_clear(tree: Hierarchy, geometry: Geometry) -> np.ndarray:
    """Return the level of the largest clear element about each patch, (n_patches,) int64.

    An element is clear where its half diagonal is below the least clearance of its patches; patches always are.
    """
    far, of = clearance(geometry), np.arange(len(geometry.patches))
    element, least = tree.leaf(of), np.full(len(tree), np.inf)
    first, second = (np.linalg.norm(edge, axis=1)[geometry.patches.face] for edge in geometry.faces.frames[1:])
    level = tree.level(element)
    while len(of):
        inner = tree.level(element) > 0
        of, element = of[inner], tree.parent(element[inner])
        np.minimum.at(least, element, far[of])
        columns, rows = tree.grid(tree.side(element), tree.level(element))
        clear = np.hypot(first[of] / columns, second[of] / rows) / 2 < least[element]
        level[of[clear]] = tree.level(element[clear])
    return level


def clearance(geometry: Geometry) -> np.ndarray:
    """Return the harmonic mean of the lengths of lines of each patch, (n_patches,) float64, in the BVH's units.

    It is infinite where all lines escape.
    """
    if "clearance" not in geometry.made:
        geometry.prepare()
        geometry.made["clearance"] = _traced(geometry)
    return geometry.made["clearance"]


def _traced(geometry: Geometry) -> np.ndarray:
    types, n = geometry.device.types, len(geometry.patches)
    UInt32, size = types.UInt32, CHUNK // LINES
    numbers = ready("sobol", types)
    shift = upload(UInt32, numbers.randomisation(stream(0, 0, Purpose.VISIBILITY)))
    words = [dr.gather(UInt32, shift, UInt32(i)) for i in range(8)]
    inverse = np.empty(n)
    for begin in range(0, n, size):
        count = min(size, n - begin)
        lane = dr.arange(UInt32, count * LINES)
        patch = lane // LINES + dr.opaque(UInt32, begin)
        record = dr.gather(types.Array2u, geometry.patch_records, patch)
        points = numbers.points(lane % LINES + 1, patch, numbers.of_patch(words, place_number(record)), 16)
        hit = first_hit(geometry, *local_line(geometry, record, points))
        found = dr.select(hit.valid, dr.rcp(hit.distance), 0)
        dr.eval(found)
        inverse[begin : begin + count] = np.array(found, np.float64).reshape(count, LINES).mean(axis=1)
    with np.errstate(divide="ignore"):
        return 1 / inverse
