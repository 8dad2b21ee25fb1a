"""The budget of a run: rays, seconds, an error or quanta; and the ladder of stages that leads there."""

import math
from dataclasses import dataclass

from ..errors import MethodError
from ..problem.quanta import LIMIT

FIRST_STAGE = 1 << 20  # quanta of all replicates together in the first stage
BLIND = 0.95 * 2**32  # lines of a replicate that an error target gets while its error cannot be judged
LEAST_QUANTA = 1024
AIM, AIM_ONCE = 0.97, 0.9  # of an error target, at the last stage; lower where no run goes on from a stage between two rungs
LEAST_STEP = 1.05  # times the lines so far
DONE = 1 << 31  # quanta, more than any baseline takes: it ends when there is nothing left to do
GATHERED = 16  # lines of a patch and replicate: by then a gather has solved along its stored lines
BASELINE_RUNGS = {"full-matrix": 1, "progressive": 64, "hierarchical": 1}  # the whole matrix; shots; passes of refinement


@dataclass(frozen=True)
class Budget:
    """The budget of a run says when it ends. Exactly one of the four is not None; but an error may have rays, seconds or both
    beside it as a limit.

    Attributes:
        rays: lines in all, replicates together.
        seconds: of wall time, compilation included.
        error: relative, of the scene (see `Solution.error`).
        quanta: N of each replicate.

    Raises:
        MethodError: none or too many are given, or a value makes no sense.
    """

    rays: float | None = None
    seconds: float | None = None
    error: float | None = None
    quanta: int | None = None

    def __post_init__(self):
        given = {name: value for name, value in vars(self).items() if value is not None}
        if not given or (len(given) > 1 and ("error" not in given or "quanta" in given)):
            raise MethodError(
                f"give exactly one of rays, seconds, error and quanta (given: {', '.join(given) or 'none'}); only an error may "
                "have rays or seconds beside it, as its limit"
            )
        for name, value in given.items():
            self._check(name, value)
            object.__setattr__(self, name, int(value) if name in ("rays", "quanta") else float(value))  # numpy's become Python's

    @staticmethod
    def _check(name: str, value) -> None:
        try:
            good = not isinstance(value, bool) and math.isfinite(value) and value > 0
        except TypeError:
            good = False
        if not good:
            raise MethodError(f"{name} is {value!r}; it must be a positive number")
        if name == "error" and value >= 1:
            raise MethodError(f"error is {value:g}; give a relative error below 1 (0.01 or, on the command line, 1%)")
        if name in ("rays", "quanta") and (value != int(value) or value < 1):
            raise MethodError(f"{name} is {value!r}; it must be a whole number of 1 or more")

    def allows(self, lines: float, seconds: float) -> bool:
        """Return whether a number of lines and a time are within the limits beside an error."""
        return (self.rays is None or lines <= self.rays) and (self.seconds is None or seconds <= self.seconds)

    def check(self, replicates: int) -> None:
        """Refuse what no run could do, before anything is traced.

        Raises:
            MethodError: no time suffices for so many lines, or a single replicate has no error.
        """
        lines = max((self.rays or 0) / replicates, self.quanta or 0)
        if lines >= LIMIT:
            raise MethodError(
                f"{lines:.3g} lines for each of {replicates} replicates are more than are counted (fewer than {LIMIT:.3g}), and "
                "would take centuries; take fewer lines"
            )
        if self.error is not None and replicates < 2:
            raise MethodError("a target error needs 2 replicates or more: a single one has no error")


def first_stage(replicates: int, n_patches: int) -> int:
    """Return N of the first rung: a power of two, so large that passes over all patches take less time than the lines."""
    return max(LEAST_QUANTA, 1 << round(math.log2(max(FIRST_STAGE / replicates, 2 * n_patches))))


def first_rung(order: str, replicates: int, share) -> int:
    """Return N of the first rung for an order.

    Staged orders begin with few lines, to show something soon. Well distributed ones begin with a quantum no larger than the
    power of the weakest light, so that every light fires.

    Args:
        share: (n_patches,) of power.
    """
    if order in BASELINE_RUNGS:
        return BASELINE_RUNGS[order]
    usual = first_stage(replicates, len(share))
    if order == "gather":  # so that all its stored lines are in the first stage
        return max(usual, 1 << (GATHERED * len(share) - 1).bit_length())
    if order == "staged":
        return LEAST_QUANTA
    if order == "well-distributed":
        return min(usual, max(LEAST_QUANTA, 1 << math.ceil(math.log2(1 / share[share > 0].min()))))
    return usual


def rung_after(quanta: int, first: int) -> int:
    """Return the rung above N on the ladder of powers of two that begins at ``first``."""
    return first if quanta < first else 1 << (quanta.bit_length())


def climb(quanta: int, first: int) -> list[int]:
    """Return the rungs up to the one above N, or to N itself where it is one."""
    rungs = [first]
    while rungs[-1] < quanta:
        rungs.append(rung_after(rungs[-1], first))
    return rungs


def stages(quanta: int, first: int) -> list[int]:
    """Stages that lead to N: rungs below it, then N."""
    return [*climb(quanta, first)[:-1], quanta]


def on_ladder(quanta: int, first: int) -> bool:
    """Return whether N is a rung."""
    return quanta >= first and quanta & (quanta - 1) == 0


@dataclass(frozen=True)
class Progressed:
    """What is known after a stage: quanta of each replicate, lines of all replicates, seconds, an upper bound of the error (NaN:
    it is not known yet), and the slope at which the error falls with lines."""

    quanta: int
    lines: int
    seconds: float
    stage_seconds: float
    error: float
    slope: float = 0.5


def next_quanta(budget: Budget, replicates: int, first: int, at: Progressed, *, replay: bool, exact: bool = False) -> int | None:
    """Return N of the next stage, or None where the budget is used up.

    The stages of any run are the rungs of the ladder below its last N, then N. So N alone replays a run, also where bands make
    the result depend on the stages (``replay``); there a stage between two rungs is the last. Integers alone do not depend on
    stages, and a run of them may go on from any N. A stage of a hundredth more lines is left out, unless N itself was asked for
    (``exact``): that repeats a run. A run for an error alone ends after `BLIND` lines where that error is still unknown.
    """
    if replay and not on_ladder(at.quanta, first):
        return None
    rung = rung_after(at.quanta, first)
    wanted = _wanted(budget, rung, at, replay)
    if wanted <= at.quanta * (1.0 if exact else 1.01):
        return None
    target = min(rung, wanted)
    blind = budget.error is not None and budget.rays is None and budget.seconds is None and math.isnan(at.error)
    if blind and at.lines / replicates * target / at.quanta > BLIND:
        return None
    return target


def missed(budget: Budget, at: Progressed, first: int) -> bool:
    """Return whether a stage that was to be the last has missed its error, and the limits leave room for another run."""
    more = 2 * rung_after(at.quanta, first) / at.quanta
    return (
        budget.error is not None
        and not at.error <= budget.error
        and not on_ladder(at.quanta, first)
        and budget.allows(at.lines * more / 2, at.seconds + at.stage_seconds * more)
    )


def _wanted(budget: Budget, rung: int, at: Progressed, replay: bool) -> int:
    """Return the least N of those that the parts of the budget ask for."""
    if budget.quanta is not None:
        return int(budget.quanta)
    wanted = []
    if budget.rays is not None:
        wanted.append(round(budget.rays * at.quanta / at.lines) if at.lines else rung)  # no line yet: try more
    if budget.seconds is not None:
        left = budget.seconds - at.seconds
        rate = max(at.lines, 1) / max(at.stage_seconds, 1e-9) / 2  # a stage fires about half of all lines so far
        wanted.append(round(at.quanta * (1 + 0.9 * left * rate / max(at.lines, 1))) if left > 0 else 0)
    if budget.error is not None:
        wanted.append(_for_error(budget.error, rung, at, replay))
    return min(wanted)


def _for_error(error: float, rung: int, at: Progressed, replay: bool) -> int:
    if at.error <= error:
        return 0
    if math.isnan(at.error):
        return rung  # more lines may tell
    aim = (AIM_ONCE if replay else AIM) * error
    return max(math.ceil(at.quanta * (at.error / aim) ** (1 / at.slope)), math.ceil(LEAST_STEP * at.quanta))
