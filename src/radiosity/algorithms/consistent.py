"""Checks of states that runs are to go on from: what is counted twice in them must be equal.

The checksums of files tell of damage when they are read. These checks find states that were put together from several ones,
changed, or captured while hits were lost.
"""

import numpy as np

from ..errors import MethodError
from ..solution.books import exact_sum


def check_ends(arrivals: np.ndarray, fired: np.ndarray, missed: np.ndarray) -> None:
    """Refuse counts of lines that did not end exactly once.

    Args:
        arrivals, fired: (replicates, n_rows), hit and fired counts.
        missed: (2, replicates), lines that escaped and were lost.

    Raises:
        MethodError: a replicate has fired more or fewer lines than have ended.
    """
    for replicate, (hits, lines) in enumerate(zip(arrivals, fired, strict=True)):
        ended, begun = exact_sum(hits) + exact_sum(missed[:, replicate]), exact_sum(lines)
        if ended != begun:
            raise MethodError(
                f"the solution to go on from is not whole: in its replicate {replicate}, {begun} lines were fired and {ended} "
                "ended; take an earlier checkpoint, or start anew"
            )
