"""The memory and time that a baseline will take, before it begins.

A baseline that needs more memory than there is is refused. For one that takes long there is a warning.
"""

import time
import warnings
from dataclasses import dataclass

import numpy as np

from ..device import memory
from ..errors import RadiosityWarning
from ..factors.rows import AbstractRows

BYTES_A_FACTOR = 96  # 12 in the matrix, the rest while pairs are sorted; 91 were measured in a closed cube
LONG = 60.0  # seconds above which a warning tells the time
PILOT_ROWS = 16


@dataclass(frozen=True)
class Estimate:
    """Memory in bytes, time in seconds (NaN: unknown), and their purpose; ``way_out`` says what would take less."""

    memory: float
    seconds: float
    what: str
    way_out: str

    def check(self) -> None:
        """Refuse a run that does not fit into memory, and warn of one that takes long.

        Raises:
            MethodError: more memory than there is.
        """
        memory.refuse(self.memory, self.what, self.way_out)
        if self.seconds > LONG:
            warnings.warn(
                f"{self.what} takes about {self.memory / 2**30:.2g} GiB and {self.seconds / 60:.2g} minutes on this machine; "
                f"{self.way_out}",
                RadiosityWarning,
                stacklevel=8,
            )


def full_matrix(rows: AbstractRows, n: int, times: float, *, reciprocal: bool) -> Estimate:
    """Return the estimate for the rows of n patches, made ``times`` times."""
    factors = float(n) * n
    what = f"the matrix of {n} patches ({factors:.2g} form factors)"
    way_out = "take larger patches, or a method that forms no matrix, such as random-walk"
    wanted = factors * BYTES_A_FACTOR * (2 if reciprocal else 1)
    if wanted > memory.room():
        return Estimate(wanted, np.nan, what, way_out)
    return Estimate(wanted, seconds_a_row(rows, n) * n * times, what, way_out)


def seconds_a_row(rows: AbstractRows, n: int) -> float:
    """Return the measured seconds of a row.

    A few rows are made and discarded, twice, since the first time compiles kernels.
    """
    some = np.unique(np.linspace(0, n - 1, min(PILOT_ROWS, rows.at_once, n)).astype(np.int64))
    seconds = 0.0
    for _ in range(2):
        begun = time.perf_counter()
        rows.make(some, 0, lambda lines: None)
        seconds = time.perf_counter() - begun
    return seconds / len(some)


def progressive(rows: AbstractRows, n: int) -> Estimate:
    """Return the estimate for n patches: a few numbers for each, and the rows that are kept.

    About one row a patch is made.
    """
    from .progressive.recent import AHEAD, MOST_ENTRIES

    wanted = 400.0 * n + 32.0 * MOST_ENTRIES + 64.0 * AHEAD * n
    what, way_out = f"progressive refinement of {n} patches", "take larger patches, or stop it early (seconds, rays)"
    fits = wanted <= memory.room()
    return Estimate(wanted, seconds_a_row(rows, n) * n if fits else np.nan, what, way_out)
