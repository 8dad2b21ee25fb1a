"""The matrix of a scene: exact form factors between polygons, times the share of each pair that is visible."""

from collections.abc import Callable

import numpy as np

from ...tracing.geometry import Geometry
from ...tracing.visibility import Polygons, visible_share
from ..missed import missed
from ..model import Factors
from .exchange import exchange

CHUNK = 1 << 18  # pairs at a time


def exact(
    geometry: Geometry, rays: int = 16, seed: int = 0, lines: int = 1024, swept: Callable[[int], None] = lambda lines: None
) -> Factors:
    """Return form factors of all pairs of patches.

    Pairs that see each other whole have exact ones, 1e-7 or better. Others have the error of their visible share, which more
    ``rays`` make smaller. Without that error rows would sum to 1 - escaped - lost; `factors.balance.restored` makes them do so.

    Args:
        rays: rays of each pair, see `visible_share`.
        lines: lines of each patch that find what escapes and what is lost, see `missed`.
        swept: called between launches with the number of lines traced since; an exception that it raises ends the work.
    """
    patches = geometry.patches
    n, area, polygons = len(patches), patches.area, Polygons.of(patches)
    found: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for one, other in _pairs(n):
        value = exchange(polygons.corners[one], polygons.corners[other])
        faces = np.flatnonzero(value)
        one, other, value = one[faces], other[faces], value[faces]
        sees = value * visible_share(geometry, polygons.take(one), polygons.take(other), rays, seed)
        seen = sees
        if geometry.some_backs_pass:
            seen = value * visible_share(geometry, polygons.take(other), polygons.take(one), rays, seed)
        swept(len(one) * rays * (2 if geometry.some_backs_pass else 1))
        for row, column, power in ((one, other, sees), (other, one, seen)):
            some = np.flatnonzero(power)
            found.append((row[some], column[some], power[some] / area[row[some]]))
    rows, columns, values = (np.concatenate(parts) for parts in zip(*found, strict=True)) if found else np.zeros((3, 0))
    order = np.lexsort((columns, rows))
    escaped, lost = missed(geometry, lines, seed)
    swept(n * lines)
    return Factors(rows[order].astype(np.int64), columns[order].astype(np.int64), values[order], escaped, lost)


def _pairs(n: int):
    """Yield pairs of different patches, each pair once, some at a time: (m,) int64 each."""
    step = max(CHUNK // max(n, 1), 1)
    for begin in range(0, n, step):
        one, other = (x.ravel() for x in np.meshgrid(np.arange(begin, min(begin + step, n)), np.arange(n), indexing="ij"))
        once = one < other
        yield one[once], other[once]
