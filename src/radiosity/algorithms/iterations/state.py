"""The state of iterations between two steps.

With a basis of K functions, groups in the layouts of arrays are columns: K for each group of bands (`Exchange`).

Each step draws its rounding offsets by its number, and all replicates of a run make the same number of steps: as many as the one
that needs most. So the steps of an incremental solution change the numbers of all later steps, in all replicates.
"""

from dataclasses import dataclass

import numpy as np

from ...errors import MethodError
from ..consistent import check_ends
from ..merge_rules import alike
from ..state import COUNTS, WHOLE, AbstractState, Record, array, number, part


@dataclass(frozen=True, eq=False, kw_only=True)
class IncrementalState(Record):
    """The state of `Incremental`; arrays over slots are flat.

    Attributes:
        received: (slots * groups,) int64, all that arrived; float64 in stages of very many quanta.
        unsent: (replicates * n_patches * groups,) float64.
        scale: the factor from received power to shares of Phi.
        progress: quanta, lines of probes that are not reported yet, and within long stages the quanta that have been emitted.
        emitted, left: (replicates, groups) int64, where power is carried in whole numbers.
        blurred: (slots * groups,), as ``received``, of `Exchange.blurred`; only where lines are refined.
    """

    received: np.ndarray = array("slots", "groups", flat=True)
    unsent: np.ndarray = array("replicates", "rows", "groups", flat=True)
    scale: float = number(float)
    progress: np.ndarray = array("any", merged=alike)
    emitted: np.ndarray | None = array("replicates", "groups", optional=True)
    left: np.ndarray | None = array("replicates", "groups", optional=True)
    blurred: np.ndarray | None = array("slots", "groups", flat=True, optional=True)

    @property
    def unfinished(self) -> bool:
        """True where power is left to send."""
        return bool(self.unsent.any()) or len(self.progress) > 2


@dataclass(frozen=True, eq=False, kw_only=True)
class RegularState(Record):
    """The state of `Regular`; arrays over slots are flat.

    Attributes:
        received: (slots * groups,) float64, the mean over iterations, a share of Phi.
        source: (turns * replicates * n_patches * groups,) float64, what the next iterations send.
        scale: 1.
        constants: (replicates, groups), the mean of the control variate's constants.
        weights: (replicates,), the sum of the weights of all iterations in the mean.
        progress: (7,) counters of `Plan`.
        warm: the warm-up, while it lasts.
        blurred: (slots * groups,) float64, the mean of `Exchange.blurred` over Phi; only where lines are refined.
    """

    received: np.ndarray = array("slots", "groups", flat=True)
    source: np.ndarray = array("any", "replicates", "rows", "groups", flat=True)
    scale: float = number(float)
    constants: np.ndarray = array("replicates", "groups")
    weights: np.ndarray = array("replicates")
    progress: np.ndarray = array(7, merged=alike)
    warm: IncrementalState | None = part(IncrementalState, "warm_", optional=True)
    blurred: np.ndarray | None = array("slots", "groups", flat=True, optional=True)

    @property
    def unfinished(self) -> bool:
        """True where lines of the stage are left, or no iteration counts yet."""
        quanta, done, summed = (int(x) for x in self.progress[:3])
        return done < quanta or summed == 0


@dataclass(frozen=True, eq=False, kw_only=True)
class ControlState(Record):
    """The state of `Control`.

    Attributes:
        beta: (replicates, groups) float64, constants.
        probe_missed: (2, replicates, n_patches) int64, probing lines escaped and lost.
        probed: (replicates, n_patches) int64, probing lines fired.
        probe_moments: (replicates, n_patches, K - 1) int64, other moments of missed lines; only with a basis of K functions.
    """

    beta: np.ndarray = array("replicates", "groups")
    probe_missed: np.ndarray = array(2, "replicates", "rows")
    probed: np.ndarray = array("replicates", "rows")
    probe_moments: np.ndarray | None = array("replicates", "rows", "any", optional=True)


def _steps(layout, values: list, records: list["IterationState"]) -> int:
    """Return the number of steps of one run with all replicates.

    In incremental iterations, replicates that need fewer steps make the rest without lines. Where regular iterations follow a
    warm-up, its length decides what all of them draw, so the runs must have the same number of steps.
    """
    if records[0].regular is not None and len(set(values)) > 1:
        raise MethodError(
            f"merge: with their warm-ups, runs took {', '.join(map(str, values))} steps, and all replicates of one run make as "
            "many as the one that needs most; solve them in one run, or take warm_up=False"
        )
    return max(values)


@dataclass(frozen=True, eq=False, kw_only=True)
class IterationState(AbstractState):
    """Counters of lines, and one of the two schemes.

    Attributes:
        arrivals, fired: (replicates, n_patches), hit counts and fired counts, uint32 where that suffices, else uint64.
        missed: (2, replicates), lines that escaped and were lost, uint32 or uint64.
        fired_apart: (sequences, replicates, n_patches), uint32 or uint64, where several sequences are taken in turn; ``fired`` is
            the sum.
        step: the number of steps so far.
        importance: (n_rows,) float64, by which lines are shared out.
        shot_done, shot_received, shot_moved: (replicates, n_rows) uint32, and flat int64, between two parts of the lines of a
            step, see `tally.shooter.Begun`. All else is then as before the step, but for the counts of lines.
    """

    arrivals: np.ndarray = array("replicates", "rows", kinds=COUNTS)
    fired: np.ndarray = array("replicates", "rows", kinds=COUNTS)
    missed: np.ndarray = array(2, "replicates", kinds=COUNTS)
    fired_apart: np.ndarray | None = array("any", "replicates", "rows", optional=True, kinds=COUNTS)
    step: int = number(int, merged=_steps)
    importance: np.ndarray | None = array("rows", optional=True, merged=alike)
    regular: RegularState | None = part(RegularState, optional=True)
    incremental: IncrementalState | None = part(IncrementalState, optional=True)
    control: ControlState | None = part(ControlState, optional=True)
    shot_done: np.ndarray | None = array("replicates", "rows", optional=True, kinds=COUNTS)
    shot_received: np.ndarray | None = array("any", optional=True, kinds=WHOLE)
    shot_moved: np.ndarray | None = array("any", optional=True, kinds=WHOLE)

    def fits_turns(self, turns: int, sequences: int) -> bool:
        """There is a source for each turn, and a count for each sequence."""
        each = self.sizes.replicates * self.sizes.rows * self.sizes.groups
        fits_source = self.regular is None or self.regular.source.size == turns * each
        return fits_source and (self.fired_apart is None or len(self.fired_apart) == sequences)

    def check_counts(self) -> None:
        """Refuse counts of lines that do not belong together.

        Raises:
            MethodError: lines were fired that did not end, or arrays of a step in parts are missing, or have other lines.
        """
        check_ends(self.arrivals, self.fired, self.missed)
        if (self.shot_done is None) != (self.shot_received is None) or (self.shot_moved is not None and self.shot_done is None):
            raise MethodError("the solution to go on from lacks a part of its step; take an earlier checkpoint, or start anew")
        if self.shot_done is not None and (self.shot_done > self.fired).any():
            raise MethodError("the solution to go on from has lines of another step; take an earlier checkpoint, or start anew")

    @property
    def scheme(self) -> RegularState | IncrementalState:
        """The state of the order."""
        found = self.regular or self.incremental
        assert found is not None
        return found

    @property
    def unfinished(self) -> bool:
        return self.shot_done is not None or self.scheme.unfinished
