"""Warnings at the end of a run that traced far more lines than it was asked for, or did not reach its error."""

import math
import warnings

from ..errors import RadiosityWarning
from ..method import Baseline, Method
from ..patches import Patches
from .budget import Budget
from .error_target import Target
from .snapshot import Snapshot

ENDS_ENOUGH = 100  # ends of spans on a mean patch of a replicate, for form factors
MORE = 2.0  # times the lines asked for


def warn_of_more(lines: int, budget: Budget, replicates: int, patches: Patches) -> None:
    """Warn of a first stage, the smallest there is, that took more than `MORE` times the lines asked for."""
    if budget.rays is not None and lines > MORE * budget.rays:
        warnings.warn(
            f"{lines:,} lines were traced, {lines / budget.rays:.3g} times the {budget.rays:,} asked for: the smallest stage of "
            f"this method with {replicates} replicates of {len(patches):,} patches takes that many; take fewer replicates, "
            "larger patches or more lines",
            RadiosityWarning,
            stacklevel=6,
        )


def warn_of_importance(lines: int, budget: Budget) -> None:
    """Warn of a pilot for importance that took more than half of the lines asked for: the run then has as many again."""
    if budget.rays is not None and lines > budget.rays / 2:
        warnings.warn(
            f"the pilot that finds importance took {lines:,} lines, and {budget.rays:,.0f} were asked for in all: the run "
            "traces as many again; give more lines, or larger patches",
            RadiosityWarning,
            stacklevel=6,
        )


def warn_of_unmet_aim(snapshot: Snapshot, target: Target) -> None:
    """Warn of a run for one result to which no line came: nothing is known of it, neither that it is dark."""
    if target.aim is not None and not snapshot.arrivals[target.rows].any():
        warnings.warn(
            f"no line came to {target.aim.name} in {snapshot.lines:,} lines, and importance was to lead them there: its light is "
            "unknown; is it shut off from all lamps? Else give more lines",
            RadiosityWarning,
            stacklevel=6,
        )


def warn_of_target(snapshot: Snapshot, budget: Budget, target: Target, bound: float, error_of: str | None) -> None:
    """Warn of an error that was not reached: say what is known of it, and what ended the run.

    Args:
        bound: the true error is below this in 95 % of runs; NaN where that is not known.
        error_of: the error target as it was asked for.
    """
    if math.isnan(bound):
        landed = int(snapshot.arrivals[target.rows].sum())
        known = f"after {snapshot.lines:,} lines it cannot be told yet ({landed:,} lines hit it)"
    else:
        known = f"after {snapshot.lines:,} lines it is {bound:.2%} or less in 95 % of runs"
    whole = "the scene" if target.aim is None else target.aim.name
    limits = [f"{name}={value:g}" for name, value in (("rays", budget.rays), ("seconds", budget.seconds)) if value is not None]
    why = f"the limit was {', '.join(limits)}" if limits else "to go on all the same, give more lines as its limit (rays)"
    warnings.warn(
        f"the error {100 * (budget.error or 0):.3g}% of {error_of or whole} was not reached: {known}; {why}",
        RadiosityWarning,
        stacklevel=6,
    )


def warn_of_few_ends(method: Method | Baseline, ends: float) -> None:
    """Warn of form factors from fewer than `ENDS_ENOUGH` ends of global lines on a patch of a replicate."""
    if isinstance(method, Method) and method.machine == "matrix" and method.lines != "local" and ends < ENDS_ENOUGH:
        warnings.warn(
            f"form factors from {ends:.3g} ends of spans a patch and replicate: the bias is of the order of one over "
            "that number, and in the stated errors; take more lines, fewer replicates, larger patches, or --lines local",
            RadiosityWarning,
            stacklevel=6,
        )
