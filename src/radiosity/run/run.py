"""The loop over the stages of a run."""

import math
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any, Generic

from ..algorithms.base import AbstractAlgorithm, AbstractMeanTally, Interrupted
from ..algorithms.in_parts import InParts, InTurn, in_parts
from ..algorithms.merging import merge as merge_states
from ..algorithms.state import AbstractState
from ..algorithms.table import make
from ..device.backend import choose, give_back_memory
from ..device.turn import turn
from ..errors import MethodError, keeping, result_kept
from ..method import Baseline, Method
from ..patches import Patches
from ..problem.model import Problem
from ..sampling.streams import Seed
from ..solution.status import NOT_REACHED
from ..tally import unmet
from ..tracing import coherent_costs
from ..tracing.geometry import Geometry
from . import memory_estimate
from .aim import Aim, shared_before
from .baseline_budget import warn_of_missing
from .budget import Budget, Progressed, climb, missed, next_quanta
from .checkpoint import Checkpoint
from .choice import Choice
from .error_target import Target
from .first_stage import FirstStage, known_ladder
from .goal import Goal
from .looks import looks
from .part import Part, check_stages
from .progress import Listener, Stop, Teller
from .record import AbstractRecord
from .refusals import refuse_depth_first
from .result import R
from .same import check_on_ladder, check_same
from .shortfall import warn_of_few_ends, warn_of_importance, warn_of_more, warn_of_target, warn_of_unmet_aim
from .snapshot import Snapshot
from .watching import Watching

LARGE = 1 << 19  # counters: before results are read, memory of wavefronts is given back, which takes some milliseconds
PATIENCE = 1.2  # times the seconds asked for: after that a stage is left unfinished


class Run(Generic[R]):
    """A problem, a method and a budget.

    The record makes the results: a `Solution`, or another value.
    """

    def __init__(
        self,
        patches: Patches,
        method: Method | Baseline,
        budget: Budget,
        part: Part,
        device: str,
        listener: Listener | None = None,
        resume: R | None = None,
        checkpoint: Checkpoint | None = None,
        error_of: str | None = None,
        choice: Choice | None = None,
        importance: Any = None,
        *,
        record: Callable[..., AbstractRecord[R]],
        problem: Problem | None = None,
    ):
        self.patches, self.method, self.budget, self.part = patches, method, budget, part
        self.replicates, self.resume, self.checkpoint = part.replicates, resume, checkpoint
        self.snapshot: Snapshot | None = None  # of the last complete stage
        self.also: Callable[[Snapshot], Any] | None = None  # what else is read of a stage
        self.watch: Callable[[R], None] | None = None  # is given the result of each complete stage
        self.watching: Watching[R] | None = None
        self.spread: Callable[[AbstractAlgorithm], AbstractAlgorithm] | None = None  # makes an algorithm run on other machines
        self.seconds_before = 0.0 if resume is None else resume.seconds
        self.problem = Problem.of(patches, through=method.machine in ("firing", "iteration")) if problem is None else problem
        refuse_depth_first(self.problem, method)
        lines = memory_estimate.lines_of(method, budget, part.replicates)
        memory_estimate.check(method, patches, self.problem.groups.n_groups, part.replicates, lines)
        self.rung = part.rung(method.order, self.problem.source.share)
        part.check(method, budget, self.rung)
        self.teller, self.stop = Teller(budget, listener, 0.0 if choice is None else choice.seconds), Stop()
        self.teller.tell("compiling")
        if choice is not None and budget.rays is not None:  # lines of the pilot are lines
            self.budget = replace(budget, rays=max(budget.rays - choice.extra_lines, 1))
        self.device = choose(device)
        made = None if choice is None else choice.geometry
        self.geometry = Geometry(self.problem.patches, self.device) if made is None else made
        aim = None if importance is None else self._share_out(importance)
        self.error_of = error_of
        self.goal = Goal(patches, budget.error, Target.of(patches, error_of, None if aim is None else aim[0]))
        given = {name: value for name, value in {**vars(budget), "error_of": error_of}.items() if value is not None}
        facts = {} if aim is None else {"importance": (aim[0].name, aim[1])}
        self.record = record(patches, method, part, self.device.name, given, None if choice is None else choice.facts, **facts)
        if resume is not None:
            check_same(resume.provenance, self.record.provenance, self.record.kind)
        coherent_costs.tell_of_none(method, self.device.name)

    def _share_out(self, importance: Any) -> tuple[Aim, int]:
        """Share lines out by importance, and return what for, and the lines that the pilot took."""
        aim = Aim.of(importance, self.geometry, self.problem.patches)
        if self.resume is None:
            self.teller.tell("importance")
            assert isinstance(self.method, Method)  # `aim.method_of`
            found = aim.shared(self.problem, self.geometry, self.method, self.part.seed)
            self.problem, lines = replace(self.problem, importance=found.values), found.lines
        else:
            self.problem, lines = shared_before(self.problem, self.resume)
        if self.budget.rays is not None:
            warn_of_importance(lines, self.budget)
            self.budget = replace(self.budget, rays=max(self.budget.rays - lines, lines))
        return aim, lines

    def solve(self) -> R:
        """Run stage after stage until the budget is used up, or until Ctrl-C."""
        with turn(), self.stop.listening(), keeping():
            return self.record.told(self._stages())

    def _stages(self) -> R:
        algorithm, target = self._spread_out(), 0
        self.algorithm = algorithm
        self.ladder = known_ladder(self.budget, algorithm)
        if self.watch is not None:
            self.watching = Watching(self.watch, self.record, self.teller, self.stop, self.seconds_before)
        if self.resume is None:
            target = self._first_quanta()
        else:
            resumed = algorithm.read(self.resume.state, algorithm.sizes)
            algorithm.restore(resumed)
            target = algorithm.quanta
            longer = self.budget.seconds is not None or self.record.budget != self.resume.provenance.get("budget")
            if longer and not algorithm.stage_independent and not resumed.unfinished:
                check_on_ladder(self.problem, self.method, target, self.rung)
        self.teller.begin(0 if self.resume is None else algorithm.swept_so_far())
        status, pending, steps = "complete", None, [*self._looks(algorithm, target), target]
        while target:
            started = time.perf_counter()
            try:
                for step in steps:
                    algorithm.advance(step, self._swept)
                    if step != target and self.watching is not None and self.teller.stage == 0:
                        self.watching.show(self._results(algorithm))
            except Interrupted as reason:
                status, pending = str(reason), algorithm.capture()
                break
            large = self.replicates * len(self.patches) > LARGE
            if large:
                give_back_memory()
            snapshot = self.snapshot = self._results(algorithm, self.also)
            known = self.replicates > 1 and self._error_matters
            error = self.goal.target.error(snapshot) if known else math.nan
            margin = self.goal.margin(snapshot)
            counted = large or (known and self.budget.error is not None)  # whoever listens: the next stage depends on this number
            lines = snapshot.lines if counted else round(snapshot.about_lines)
            self.teller.complete(lines, target, error, margin, algorithm.tally.swept_lines(self.problem, snapshot.state))
            if self.watching is not None:
                self.watching.show(snapshot)
            if self.stop.asked and not snapshot.done:
                status = "interrupted"
                break
            if snapshot.done or self.goal.dark(snapshot):
                break
            stage, slope = time.perf_counter() - started, self.teller.slope
            at = Progressed(target, lines, self.teller.elapsed, stage, error * margin, slope)
            replay = not algorithm.stage_independent
            if replay and missed(self.budget, at, self.rung):
                self.algorithm = algorithm = self._spread_out()
                steps = climb(target, self.rung)  # from N itself no run goes on to the bits of a longer one
                target = steps[-1]
                continue
            exact = self.budget.quanta is not None
            target = next_quanta(self.ladder, self.replicates, self.rung, at, replay=replay, exact=exact)
            steps = [target] if target else []
            if target and large and self.replicates > 1:
                snapshot.settle()
                give_back_memory()
        if self.snapshot is None:
            solution = self._so_far(status, pending or algorithm.capture())
        else:
            if status == "complete" and self.budget.error is not None and not self.goal.reached(self.snapshot, self.teller.bound):
                status = NOT_REACHED
            solution = self._solution(self.snapshot, status, pending)
        if self.checkpoint is not None:
            self.checkpoint.end(solution)
        if solution.quanta == 0:
            raise KeyboardInterrupt
        if self.snapshot is not None:
            with result_kept():
                self.goal.warn_of_dark(self.snapshot)
        return solution

    def merged(self, quanta: int, parts: list[tuple[dict, Part]]) -> R:
        """The solution of this run after N quanta, from arrays of the states of its parts, in the order of their replicates.

        Raises:
            MethodError: see `run.merge.merge`.
        """
        algorithm = self._algorithm(self.problem, self.part)
        states = [algorithm.read(arrays, replace(algorithm.sizes, replicates=part.replicates)) for arrays, part in parts]
        for state, (_, part) in zip(states, parts, strict=True):
            if state.quanta != quanta:
                raise MethodError(
                    f"cannot merge replicates {part.range}: they are within the stage of {state.quanta} quanta, after {quanta}; "
                    "go on to the end (resume)"
                )
        state = merge_states(states)
        if not algorithm.stage_independent:
            share = self.problem.source.share
            check_stages(self.method, quanta, self.rung, [(part, part.rung(self.method.order, share)) for _, part in parts])
        return self._solution(Snapshot(self.problem, algorithm.tally, state, self.replicates), "complete", None)

    def _results(self, algorithm: AbstractAlgorithm, also: Callable[[Snapshot], Any] | None = None) -> Snapshot:
        """Return the results of what an algorithm has traced."""
        return Snapshot(self.problem, algorithm.tally, algorithm.capture(), self.replicates, also)

    def _looks(self, algorithm: AbstractAlgorithm, first: int) -> list[int]:
        """Return N of the looks within the first stage, for who watches the run.

        Where results depend on their stages, looks are traced beside the run before it begins, and none are left.
        """
        if self.watching is None or self.resume is not None:
            return []
        beside = not algorithm.stage_independent
        found = looks(first, self.ladder, self.rung, beside=beside)
        if not beside:
            return found
        if self.replicates * len(self.patches) <= LARGE:
            self.watching.show_beside(found, self._algorithm(self.problem, self.part), self._results)
        return []

    def _so_far(self, status: str, state: AbstractState) -> R:
        """Results of the last complete stage, if any, and a state to go on from."""
        seconds = self.teller.elapsed + self.seconds_before
        if self.snapshot is not None:
            return self.record.result(self.snapshot, status, state, seconds)
        return self.record.unfinished(self.resume, status, state, seconds)

    def _algorithm(self, problem: Problem, part: Part) -> AbstractAlgorithm:
        return make(self.geometry, problem, self.method, part.seed, part.replicates)

    def _spread_out(self) -> AbstractAlgorithm:
        """Return the algorithm of the run: on other machines, or in parts where it goes on from such a run, or else here."""
        whole = self._algorithm(self.problem, self.part)
        if self.spread is not None:
            return self.spread(whole)
        return InParts(whole, InTurn()) if self.resume is not None and in_parts(self.resume.state) else whole

    @property
    def _error_matters(self) -> bool:
        """True where an error target or a listener needs the error between stages; it costs a pass over all replicates."""
        return self.record.has_errors and (self.budget.error is not None or self.teller.listener is not None)

    def _swept(self, count: int) -> None:
        self.teller.lines += count
        self.teller.tell("tracing")
        if self.stop.asked:
            raise Interrupted("interrupted")
        seconds = self.budget.seconds
        if seconds is not None and self.teller.stage and self.teller.elapsed > PATIENCE * seconds + 1:
            raise Interrupted("complete")
        if self.checkpoint is not None and self.checkpoint.due(self.algorithm.behind()):
            self.checkpoint.write(lambda: self._so_far("interrupted", self.algorithm.capture()))

    def _first_quanta(self) -> int:
        """Return N of the first stage."""
        first = FirstStage(self.ladder, self.budget, self.rung, self.replicates)
        known = first.known(self.method, watched=self.watch is not None)
        if known is not None:
            return known
        counted = self.problem.scalar if self.method.machine == "firing" else self.problem
        return first.tried(self._algorithm(counted, Part(Seed(self.part.seed.value), 1)), self._pilot_told)

    def _pilot_told(self, count: int) -> None:
        self.teller.tell("trying")
        if self.stop.asked:
            raise KeyboardInterrupt

    def _solution(self, snapshot: Snapshot, status: str, pending: AbstractState | None) -> R:
        solution = self.record.result(snapshot, status, pending or snapshot.state, self.teller.elapsed + self.seconds_before)
        with result_kept():
            if self.resume is None:
                warn_of_more(snapshot.lines, self.budget, self.replicates, self.patches)
            if status == NOT_REACHED:
                warn_of_target(snapshot, self.budget, self.goal.target, self.teller.bound, self.error_of)
            else:
                warn_of_unmet_aim(snapshot, self.goal.target)
            if isinstance(snapshot.tally, AbstractMeanTally):
                unmet.warn(self.patches, snapshot.tally.measured(self.problem, snapshot.state))
            warn_of_few_ends(self.method, snapshot.lines / self.replicates / len(self.patches))
            if isinstance(self.method, Baseline):
                cut_short = status != "interrupted" and self.budget.quanta is None
                warn_of_missing(self.method, snapshot.books, snapshot.state, cut_short=cut_short)
        return self.record.told(solution)
