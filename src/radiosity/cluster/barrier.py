"""Units of work between two barriers: each goes to a worker, and what no worker brings back is done here."""

import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from ..algorithms.base import Interrupted
from ..device.turn import aside
from .crew import AWAKE, FAILED_TO_COME, LONELY, DaskCrew, fetched
from .worker import Brought, Missing


@dataclass(eq=False)
class Barrier:
    """Hands out the units of a step, and waits for all of them.

    Attributes:
        crew: whose workers.
        work: the function that runs on workers, of the key of the job and a unit.
        here: does a unit here.
        rates: lines a second of each worker, by its address.
        over: True once the scheduler is lost.
    """

    crew: DaskCrew
    work: Callable[[str, Any], Brought]
    here: Callable[[Any], list]
    rates: dict[str, float] = field(default_factory=dict)
    over: bool = False

    def workers(self) -> dict[str, int]:
        """Return the workers there are; none once the scheduler is lost."""
        try:
            return {} if self.over else self.crew.workers()
        except Interrupted:
            self.over = True
            return {}

    def rate(self, address: str) -> float:
        """Return the rate of a worker; of a new one, that of a middling worker."""
        known = sorted(self.rates.values())
        return self.rates.get(address, known[len(known) // 2] if known else 1.0)

    def done(self, units: list[Any], lines_of: Callable[[Any], int]) -> Iterator[Any]:
        """Yield what each unit brings, in any order."""
        waiting, active = list(units), {}
        lonely = time.monotonic()
        try:
            while waiting or active:
                workers = self.workers()
                if self.over:
                    break
                busy = {address for _, address in active.values()}
                for address in [address for address in workers if address not in busy][: len(waiting)]:
                    lonely = time.monotonic()
                    self._submit(waiting.pop(), address, active)
                if not active and time.monotonic() - lonely > LONELY:
                    self.crew.tell("there are no workers; their lines are traced here until one comes")
                    yield from self.here(waiting.pop())
                for unit, found in self._ended(active):
                    if found is None:
                        waiting.append(unit)
                        continue
                    self.note(lines_of(unit), found)
                    yield from found.what
            for unit in [*waiting, *(unit for unit, _ in active.values())]:
                yield from self.here(unit)
        finally:
            for future in active:
                _cancel(future)

    def together(self, units: dict[str, Any], work: Callable[..., Brought], end: Callable[[], None]) -> list[Brought]:
        """Return what units bring that workers do together, each by its address: all of them, or nothing.

        Args:
            work: as of the class.
            end: tells the workers to return early, where one of them has gone or the run is to stop.
        """
        active, found, told = {}, list[Brought](), False
        try:
            for address, unit in units.items():
                self._submit(unit, address, active, work)
            while active:
                found += [outcome for _, outcome in self._ended(active) if outcome is not None]
                lost = len(found) + len(active) < len(units)
                if (lost or self.crew.stopping()) and not told:
                    told = True
                    end()
        finally:
            for future in active:
                _cancel(future)
        return found if len(found) == len(units) else []

    def _submit(self, unit: Any, address: str, active: dict, work: Callable[..., Brought] | None = None) -> None:
        name = f"radiosity-{uuid.uuid4().hex}"
        given = {"pure": False, "workers": [address], "key": name}
        future = self.crew.client.submit(work or self.work, self.crew.job.key, unit, **given)
        future.add_done_callback(lambda _: self.crew.awake.set())
        active[future] = (unit, address)

    def _ended(self, active: dict) -> Iterator[tuple[Any, Brought | None]]:
        """Wait a moment, and yield the units that have ended, and what each brought: None where its worker has gone."""
        with aside():
            self.crew.awake.wait(AWAKE)
        self.crew.awake.clear()
        workers = self.workers()
        for future, (unit, address) in list(active.items()):
            if future.status != "pending" or address not in workers:
                del active[future]
                yield unit, self._outcome(future)

    def note(self, lines: int, found: Brought) -> None:
        """Note the rate of a worker, and refuse one that would give other bits."""
        self.crew.check(found.facts, found.address)
        rate, before = lines / max(found.seconds, 1e-6), self.rates.get(found.address)
        self.rates[found.address] = rate if before is None else (before + rate) / 2

    def _outcome(self, future: Any) -> Brought | None:
        """Return what a unit brought; None where it must be handed out again."""
        from distributed import KilledWorker

        if future.status == "finished":
            return fetched(future)
        if future.status == "error":
            error = future.exception()
            if isinstance(error, Missing):
                self.crew.register()
            elif not isinstance(error, (*FAILED_TO_COME, KilledWorker)):
                raise error
        _cancel(future)
        return None


def _cancel(future: Any) -> None:
    with suppress(Exception):  # the scheduler may have gone
        future.cancel()
