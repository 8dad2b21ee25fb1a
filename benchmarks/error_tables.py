"""Tables of ``make bench-error``: seconds to targets, and errors after equal seconds."""

import numpy as np
from error_formulas import Time, error_at, time_to
from error_references import Reference
from error_scenes import OLD
from history import note

PART = 1 / 3  # of a target: a reference with a larger error does not tell when the target is reached
WIDTH = 64
SECONDS = ("cpu", "wall")
ERRORS = ("patches", "surface means")


def tables(ladders: dict, targets: list[float]) -> None:
    """Print both tables; ratios are to the old random walk, or to the first method."""
    base = OLD if OLD in ladders else next(iter(ladders))
    print(f"  seconds to an error (* extrapolated, < reached by the smallest run); in brackets how many times faster than {base}")
    for target in targets:
        of_base = times(ladders[base], target)
        for method, ladder in ladders.items():
            own = times(ladder, target)
            words = [f"{of} {own[of]} ({ratio(of_base[of], own[of])})" for of in SECONDS]
            reason = why_not(ladder.truth, target)
            print(f"    {target:.2%}  {method:<{WIDTH}} " + (f"not told: {reason}" if reason else "   ".join(words)))
    for number, seconds in enumerate(common(ladders)):
        if not number:
            print(
                f"  errors after equal CPU time (~ below the reference's own); in brackets how many times smaller than by {base}"
            )
        of_base = after(ladders[base], seconds)
        for method, ladder in ladders.items():
            own, least = after(ladder, seconds), (ladder.truth.error, ladder.truth.means_error)
            words = [f"{name} {smaller(*values)}" for name, *values in zip(ERRORS, of_base, own, least, strict=True)]
            print(f"    {seconds:.2f} s  {method:<{WIDTH}} " + "   ".join(words), flush=True)


def notes(name: str, ladders: dict, targets: list[float]) -> None:
    """Keep the seconds of CPU and wall for the history."""
    for method, ladder in ladders.items():
        for target in targets:
            for of, time in times(ladder, target).items():
                if np.isfinite(time.seconds):
                    note(f"{name} to {target:.2%} by {method}, {of}", time.seconds, "s")


def times(ladder, target: float) -> dict[str, Time]:
    """Seconds of CPU and wall to a target, unknown where the reference cannot tell."""
    if why_not(ladder.truth, target):
        return dict.fromkeys(SECONDS, Time(float("nan")))
    return {of: time_to(target, ladder.errors, getattr(ladder, of)) for of in SECONDS}


def after(ladder, seconds: float) -> tuple[float, float]:
    """Errors of patches and of surface means after some seconds of CPU."""
    return error_at(seconds, ladder.errors, ladder.cpu), error_at(seconds, ladder.means, ladder.cpu)


def why_not(truth: Reference, target: float) -> str:
    """The reason why a reference cannot tell when a target is reached, or an empty text."""
    if not truth.agrees:
        return "the methods that made the reference disagree"
    if truth.error > PART * target:
        return f"the reference's own error is {truth.error:.3%}, more than a third of it"
    return ""


def ratio(base: Time, other: Time) -> str:
    """The ratio of two times, with the marks of both."""
    if not np.isfinite([base.seconds, other.seconds]).all():
        return "-"
    marks = "".join(sorted({base.mark, other.mark}))
    return f"{base.seconds / other.seconds:.2f}{marks}"


def smaller(base: float, error: float, own: float) -> str:
    """An error, marked where it is below the reference's own, and the base's over it."""
    rough = "~" if error < own else ""
    return f"{error:.3%}{rough} ({base / error:.2f})" if error > 0 else f"{error:.3%}{rough}"


def common(ladders: dict) -> list[float]:
    """A short and a long time that all methods have runs below and above, if there are any."""
    first = max(ladder.cpu[0] for ladder in ladders.values())
    last = min(ladder.cpu[-1] for ladder in ladders.values())
    return [] if first > last else sorted({min(2 * first, last), last})
