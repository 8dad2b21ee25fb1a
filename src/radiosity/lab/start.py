"""The start of a run (section 3): what is known after few lines, by the order in which they are fired.

- Depth-first: complete walks, more and more of them.
- Staged: complete small solutions, each of which uses the lines of those before.
- Breadth-first: one solution of a fixed number of quanta, read after each wavefront. Light reflected k times is missing until
  wavefront k.
"""

from dataclasses import dataclass

import numpy as np

from ..algorithms.table import make
from ..device.backend import choose
from ..method import Method
from ..problem.model import Problem
from ..tracing.geometry import Geometry
from .measure import deviations, radiosity
from .study import Case

LAST = 13  # up to 2^13 lines of a replicate
REPLICATES = 64


@dataclass(frozen=True, eq=False)
class Start:
    """Errors after few lines.

    Attributes:
        order: its name in the legend.
        lines: (k,) of one replicate. errors: (REPLICATES, k), area-weighted RMS.
    """

    order: str
    lines: np.ndarray
    errors: np.ndarray


def starts(case: Case, truth: np.ndarray, seed: int) -> list[Start]:
    """Return the starts of depth-first, staged and breadth-first runs, with Halton numbers."""
    problem, geometry = Problem.of(case.patches), Geometry(case.patches, choose("cpu"))

    def follow(order: str, quanta: list[int], *, within: bool):
        algorithm = make(geometry, problem, Method(order=order, randomisation="shared"), seed, REPLICATES)
        lines, errors = [], []

        def note(_lines=0):
            state = algorithm.capture()
            lines.append(algorithm.tally.lines(problem, state) / REPLICATES)
            found = radiosity(algorithm, problem, state)
            errors.append(deviations(case, found, truth, absolute=case.exact is not None)[0])

        for n in quanta:
            algorithm.advance(n, note if within else lambda _: None)
            if not within:
                note()
        return np.array(lines), np.stack(errors, axis=1)

    mean = float(case.patches.area @ case.patches.reflectance[:, 0] / case.patches.area.sum())
    most = round((1 << LAST) * (1 - mean))
    ladder = [max(1, most >> k) for k in range(LAST - 3, -1, -1)]
    dense = sorted({max(1, round(most * 2 ** (-k / 2))) for k in range(2 * LAST - 6)})
    return [
        Start("depth-first", *follow("depth-first", dense, within=False)),
        Start("staged", *follow("staged", sorted(set(ladder)), within=False)),
        Start("breadth-first", *follow("breadth-first", [most], within=True)),
    ]
