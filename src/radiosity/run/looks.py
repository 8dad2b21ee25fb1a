"""Looks: results that are shown to who watches a run before its first stage is complete, so that short runs show some."""

from .budget import Budget, stages

SHOWN = 5  # results, the last one included
CHEAP = 1 / 4  # of the first stage: what all looks together may cost where they are traced beside the run


def looks(first: int, budget: Budget, rung: int, *, beside: bool) -> list[int]:
    """Return N of each look, in rising order; none where a run has enough stages of its own.

    Args:
        first: N of the first stage.
        budget: of the run.
        rung: first one of the ladder.
        beside: lines of the looks are traced beside the run, and thrown away; otherwise they are those of the first stage.
    """
    own = len(stages(int(budget.quanta), rung)) if budget.quanta is not None else 1
    top = first * CHEAP if beside else first
    wanted = (int(top / 2**k) for k in range(SHOWN - own, 0, -1))
    return [quanta for quanta in dict.fromkeys(wanted) if quanta >= 1]
