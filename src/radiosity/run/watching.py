"""Who watches a run is given its results while it goes on; nothing of what they do comes back."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Generic

from ..algorithms.base import AbstractAlgorithm, Interrupted
from ..device.turn import aside
from .progress import Stop, Teller
from .record import AbstractRecord
from .result import R
from .snapshot import Snapshot


@dataclass(frozen=True, eq=False)
class Watching(Generic[R]):
    """Shows results to who watches a run.

    Attributes:
        watch: is given each result.
        record: makes results.
        teller, stop: of the run.
        seconds_before: of the runs that it goes on from.
    """

    watch: Callable[[R], None]
    record: AbstractRecord[R]
    teller: Teller
    stop: Stop
    seconds_before: float

    def show(self, snapshot: Snapshot) -> None:
        """Give the result of a stage to who watches."""
        solution = self.record.result(snapshot, "running", snapshot.state, self.teller.elapsed + self.seconds_before)
        with aside():
            self.watch(solution)

    def show_beside(self, quanta: list[int], own: AbstractAlgorithm, results: Callable[[AbstractAlgorithm], Snapshot]) -> None:
        """Trace looks beside the run before it begins, and show them.

        Args:
            quanta: of each look.
            own: the algorithm for them alone.
            results: reads what it has traced.
        """

        def looked(count: int) -> None:
            self.teller.tell("first looks")
            if self.stop.asked:
                raise Interrupted("interrupted")

        with suppress(Interrupted):  # the run itself sees that it is to stop
            for n in quanta:
                own.advance(n, looked)
                self.show(results(own))
