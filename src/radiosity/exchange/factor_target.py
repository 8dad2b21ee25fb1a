"""View factors to an error: the run takes more lines until it is reached."""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..errors import MethodError, RadiosityWarning
from ..run.budget import Budget
from ..scene.named import surfaces_called
from ..solution.errors import inner_products, margin
from ..solution.intervals import FEW
from .view_factors import ViewFactors

ROW = "row:"
FIRST = 64  # lines of a patch in the first run
MOST, ENDLESS = 2**34, 2**60  # lines in all, where there is no limit: while the error is unknown, and when it is known
LEAP = 4  # most doublings from a run to the next
NORMAL = 1.645  # standard deviations that 95 % are below
SLOPE = 0.5  # of the error against work, by which the next run is chosen


@dataclass(frozen=True)
class FactorTarget:
    """An error that view factors must reach: the RMS error of all factors over their RMS, or of those of some rows.

    Attributes:
        error: relative.
        name: the group whose row it is, or a pattern; None: all rows.
    """

    error: float
    name: str | None = None

    @staticmethod
    def of(error, error_of: str | None) -> "FactorTarget":
        """Make the target from arguments; ``error_of`` is ``row:NAME`` or None.

        Raises:
            MethodError: the error is out of range, or the text has another form.
        """
        try:
            good = not isinstance(error, bool | str) and 0 < float(error) < 1
        except (TypeError, ValueError):
            good = False
        if not good:
            raise MethodError(f"error is {error!r}; it must be above 0 and below 1, such as 0.01")
        if error_of is None:
            return FactorTarget(float(error))
        name = str(error_of).removeprefix(ROW)
        if not str(error_of).startswith(ROW) or not name:
            raise MethodError(f"error_of is '{error_of}'; write {ROW}NAME, a row of the table")
        return FactorTarget(float(error), name)

    def check(self, names: tuple[str, ...]) -> None:
        """Refuse a row that there is not, before any line.

        Raises:
            MethodError: no group is called so.
        """
        if self.name is not None:
            surfaces_called(names, self.name)

    def bound(self, factors: ViewFactors) -> float:
        """Return the relative error that the true one is below in 95 % of runs; NaN where a row has fewer than 30 lines."""
        rows = np.arange(len(factors)) if self.name is None else surfaces_called(factors.names, self.name)
        here = np.isin(factors.rows, rows)
        lines = np.bincount(factors.rows, np.where(factors.hits < 0, FEW, factors.hits), len(factors))
        variance = float((factors.errors[here] ** 2).sum())
        size = float((factors.values[here] ** 2).sum()) - variance  # the errors are in the squares of the values, too
        if (lines[rows] < FEW).any() or not np.isfinite(variance) or size <= 0:
            return float("nan")
        wide = 1.0
        if factors.samples is not None:
            wide = margin(inner_products(factors.samples[:, here], np.ones(int(here.sum()))), factors.replicates)
        elif variance > 0:  # the sum of squared errors is spread by this much; both directions of a pair are one number
            spread = float((factors.errors[here] ** 4).sum()) ** 0.5 / variance
            wide = (1 + NORMAL * 2 * spread) ** 0.5
        return wide * float(np.sqrt(variance / size))


def until(target: FactorTarget, make: Callable[[int], ViewFactors], patches: int, replicates: int, rays) -> ViewFactors:
    """Return the factors of the first run that reaches an error. Each run has twice the work of the one before, or more.

    Args:
        make: makes factors after the work of a number of lines.
        rays: the largest number, or None.

    Raises:
        MethodError: a single replicate, which tells no error.
    """
    if replicates < 2:
        raise MethodError("an error can be reached with 2 replicates or more; one alone tells none")
    most = int(Budget(rays=ENDLESS if rays is None else rays).rays or 0)
    goal, last = min(max(FIRST * patches, 2000 * replicates), most), None
    while True:
        try:
            found = make(goal)
        except KeyboardInterrupt:
            if last is None:
                raise
            return replace(last, status="interrupted")
        bound = target.bound(found)
        if bound <= target.error or found.status != "complete":
            return found
        known = np.isfinite(bound)
        if goal >= most or (rays is None and not known and goal >= MOST):
            break
        doublings = np.log2(bound / target.error) / SLOPE if known else 1.0
        goal, last = min(goal * 2 ** int(np.clip(np.ceil(doublings), 1, LEAP)), most), found
    text = f"is {bound:.2%}" if np.isfinite(bound) else "cannot be judged from so few lines"
    warnings.warn(
        f"the error asked for, {target.error:.2%}, was not reached with {found.rays:,} lines: it {text}; take more rays",
        RadiosityWarning,
        stacklevel=4,
    )
    return replace(found, status="not reached")
