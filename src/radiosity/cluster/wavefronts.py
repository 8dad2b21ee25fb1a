"""Wavefronts of one run on several workers: ranges of lines, whose hits are summed at a barrier."""

import time
import uuid
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from ..algorithms.base import Interrupted
from ..algorithms.firing.elsewhere import AbstractFirer, Hits, Lines, cut
from ..device.turn import aside
from .crew import AWAKE, FAILED_TO_COME, LONELY, DaskCrew
from .worker import Fired, Missing, fire, fire_all

FEWEST = 1 << 17  # lines of a unit: smaller ones are given to fewer workers, and wavefronts of fewer than two are fired here


@dataclass(eq=False)
class DaskFirer(AbstractFirer):
    """Fires the lines of a wavefront on the workers of a crew.

    Each worker gets lines in proportion to the rate at which it has traced before. What no worker brings back is fired here.

    Attributes:
        crew: whose workers.
        rates: lines a second of each worker, by its address.
    """

    crew: DaskCrew
    rates: dict[str, float] = field(default_factory=dict)
    least: int = field(default_factory=lambda: 2 * FEWEST)
    over: bool = False

    def fire(self, lines: list[Lines]) -> Iterator[Hits]:
        workers = self._workers()
        total = sum(one.total for one in lines)
        most = max(1, total // FEWEST)
        chosen = sorted(workers, key=lambda address: -self._rate(address))[:most]
        if not chosen:
            yield from self._here(lines)
            return
        waiting = [one for one in cut(lines, [self._rate(address) for address in chosen]) if one]
        active: dict[Any, tuple[list[Lines], str]] = {}
        lonely = time.monotonic()
        try:
            while waiting or active:
                busy = {address for _, address in active.values()}
                for address in [address for address in workers if address not in busy][: len(waiting)]:
                    lonely = time.monotonic()
                    self._submit(waiting.pop(), address, active)
                if not active and time.monotonic() - lonely > LONELY:
                    self.crew.tell("there are no workers; their lines are traced here until one comes")
                    yield from self._here(waiting.pop())
                with aside():
                    self.crew.awake.wait(AWAKE)
                self.crew.awake.clear()
                workers = self._workers()
                if self.over:
                    break
                for future, (unit, address) in list(active.items()):
                    if future.status == "pending" and address in workers:
                        continue
                    del active[future]
                    found = self._outcome(future)
                    if found is None:
                        with suppress(Exception):
                            future.cancel()
                        waiting.append(unit)
                        continue
                    self._note(unit, found)
                    yield from found.hits
            for unit in [*waiting, *(unit for unit, _ in active.values())]:  # the scheduler is lost
                yield from self._here(unit)
        finally:
            for future in active:
                with suppress(Exception):  # the scheduler may have gone
                    future.cancel()

    def _workers(self) -> dict[str, int]:
        try:
            return self.crew.workers()
        except Interrupted:
            self.over = True
            return {}

    def _rate(self, address: str) -> float:
        """Return the rate of a worker; of a new one, that of a middling worker."""
        known = sorted(self.rates.values())
        return self.rates.get(address, known[len(known) // 2] if known else 1.0)

    def _note(self, unit: list[Lines], found: Fired) -> None:
        self.crew.check(found.facts, found.address)
        rate, before = sum(one.total for one in unit) / max(found.seconds, 1e-6), self.rates.get(found.address)
        self.rates[found.address] = rate if before is None else (before + rate) / 2

    def _submit(self, unit: list[Lines], address: str, active: dict) -> None:
        future = self.crew.client.submit(
            fire, self.crew.job.key, unit, pure=False, workers=[address], key=f"radiosity-{uuid.uuid4().hex}"
        )
        future.add_done_callback(lambda _: self.crew.awake.set())
        active[future] = (unit, address)

    def _outcome(self, future: Any) -> Fired | None:
        """Return what a unit brought; None where it must be fired again."""
        from distributed import KilledWorker

        if future.status == "finished":
            with suppress(*FAILED_TO_COME):
                return future.result()
            return None
        if future.status != "error":
            return None
        error = future.exception()
        if isinstance(error, Missing):
            self.crew.register()
        elif not isinstance(error, (*FAILED_TO_COME, KilledWorker)):
            raise error
        return None

    def _here(self, lines: list[Lines]) -> Iterator[Hits]:
        yield from fire_all(self.crew.job, lines)
