"""The crew of a run: hands out its parts to workers, takes their states back, and bears that workers come, go and die."""

import threading
import time
import uuid
import warnings
from collections import deque
from collections.abc import Callable
from concurrent.futures import CancelledError
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ..algorithms.base import Interrupted, Swept
from ..algorithms.in_parts import AbstractCrew, InParts, Share
from ..algorithms.splitting import split
from ..device.turn import aside
from ..errors import DeviceError, RadiosityWarning
from .job import INSTRUCTIONS, facts
from .worker import Missing, Outcome, Unit, advance, owned

SECONDS = 4.0  # of a unit at least: what a killed worker can lose
TIMES = 30  # a unit lasts for as many times what it takes to send it and its state: the least that the last few took
MOST_SECONDS = 60.0
LAST = 4  # units of a worker: a busy machine holds some of them up
AWAKE = 0.2  # seconds between two looks at Ctrl-C, the clock and the workers
LOOK = 1.0  # seconds between two looks at which workers there are
SMALL = 1 << 20  # bytes that are sent along with a task; more is sent to the worker first
DEATHS = 8  # workers that may die in a row without a part coming back, before the run ends
LONELY = 30.0  # seconds without workers before that is told
FAILED_TO_COME = (OSError, CancelledError)  # of what a task needs: the worker that had it has gone
FETCH = 5.0  # seconds for a result to come, at first, before it is looked whether its worker still has it
LOST = 10.0  # seconds without an answer from the scheduler before it counts as lost


def fetched(future: Any) -> Any:
    """Return what a task that has finished brought; None where the worker that has it died before it came.

    Dask would then wait for the task to run again, which no worker that is left may do.
    """
    patience = FETCH
    while future.status == "finished":
        try:
            return future.result(timeout=patience)
        except TimeoutError:  # before `FAILED_TO_COME`: it is an OSError, too
            patience *= 2
        except FAILED_TO_COME:
            break
    return None


@dataclass(eq=False)
class Active:
    """A unit that a worker works on, handed out when it was ``begun``."""

    share: Share
    address: str
    begun: float


@dataclass(eq=False)
class DaskCrew(AbstractCrew):
    """Workers of a Dask scheduler.

    Attributes:
        client: a `distributed.Client`.
        job: which every worker has.
        together: why all replicates must advance together; "" where they need not.
        before: jobs that the job needs on workers, and which somebody else takes off them.
        stopping: tells whether the run was asked to stop.
        lost: what happened to the cluster, where that has ended the run; else "".
    """

    client: Any
    job: Any  # a `Job`, or another value that has a key
    together: str = ""
    before: tuple[Any, ...] = ()
    stopping: Callable[[], bool] = lambda: False
    lost: str = ""
    _tokens: WeakKeyDictionary[Any, tuple[str, str]] = field(default_factory=WeakKeyDictionary)  # of states: token and worker
    _threads: dict[str, int] = field(default_factory=dict)
    _looked: float = -1e9
    _heard: float = field(default_factory=time.monotonic)
    _active: dict[Any, Active] = field(default_factory=dict)
    _sending: dict[str, deque[float]] = field(default_factory=dict)  # seconds of each worker's last units
    _deaths: int = 0
    _told: set[str] = field(default_factory=set)
    awake: threading.Event = field(default_factory=threading.Event)

    # ---- workers ---------------------------------------------------------------------------------------------------

    def workers(self) -> dict[str, int]:
        """Return the addresses of the workers there are now, and the threads of each."""
        now = time.monotonic()
        if now - self._looked < LOOK:
            return self._threads
        self._looked = now
        if self.client.status == "running":
            with suppress(OSError, TimeoutError):
                self._threads = dict(self.client.nthreads())
                self._heard = time.monotonic()
        if self.client.status == "closed" or time.monotonic() - self._heard > LOST:
            self.lost = f"the scheduler {self.client.scheduler.address} does not answer any more"
            raise Interrupted("interrupted")
        return self._threads

    def cut(self, replicates: int) -> list[int]:
        """One part a worker; all replicates in one where they must advance together."""
        parts = 1 if self.together else min(max(len(self.present()), 1), replicates)
        return [replicates * (at + 1) // parts - replicates * at // parts for at in range(parts)]

    def present(self) -> dict[str, int]:
        """Return the workers; where there are none yet, wait for the first for a while."""
        begun = time.monotonic()
        while not (there := self.workers()) and time.monotonic() - begun < LONELY:
            with aside():
                time.sleep(AWAKE)
        return there

    # ---- units -----------------------------------------------------------------------------------------------------

    def complete(self, run: InParts, shares: list[Share], quanta: int, swept: Swept) -> None:
        self._active = active = dict[Any, Active]()
        lonely = time.monotonic()
        try:
            while not all(share.done for share in shares):
                workers = self.workers()
                if workers:
                    lonely = time.monotonic()
                elif time.monotonic() - lonely > LONELY:
                    self.tell("there are no workers; the run goes on when one comes")
                self._split(shares, active, workers)
                self._hand_out(run, shares, active, quanta, workers)
                with aside():
                    self.awake.wait(AWAKE)
                self.awake.clear()
                swept(self._take_back(run, shares, active))
        finally:
            for future in active:
                with suppress(Exception):  # the scheduler may have gone
                    future.cancel()
            self._active = {}

    def behind(self) -> float:
        now = time.monotonic()
        return max((now - one.begun for one in self._active.values()), default=0.0)

    def _split(self, shares: list[Share], active: dict[Any, Active], workers: dict[str, int]) -> None:
        """Give idle workers half of what waits, where states can be split within a stage."""
        busy = {id(one.share) for one in active.values()}
        waiting = [share for share in shares if not share.done and id(share) not in busy]
        idle = len(workers) - len(active) - len(waiting)
        for share in sorted(waiting, key=lambda share: -share.count)[: max(idle, 0)]:
            if share.count > 1 and share.state is not None and share.state.splits_within and not self.together:
                counts = [share.count - share.count // 2, share.count // 2]
                states = split(share.state, counts)
                halves = [Share(share.first, counts[0], states[0]), Share(share.first + counts[0], counts[1], states[1])]
                at = next(at for at, one in enumerate(shares) if one is share)
                shares[at : at + 1] = halves

    def _hand_out(self, run: InParts, shares: list[Share], active: dict, quanta: int, workers: dict[str, int]) -> None:
        """Give each idle worker a part that nobody works on: the one that it had before, where there is one."""
        busy, at_work = {id(one.share) for one in active.values()}, {one.address for one in active.values()}
        waiting = [share for share in shares if not share.done and id(share) not in busy]
        idle = [address for address in workers if address not in at_work]
        for address in idle:
            if not waiting:
                return
            own = [share for share in waiting if self._of(share)[1] == address]
            strangers = [s for s in waiting if self._of(s)[1] not in idle]
            share = (own or strangers or waiting)[0]
            waiting.remove(share)
            self._submit(share, address, active, quanta)

    def _of(self, share: Share) -> tuple[str, str]:
        """Return the token of a share's state, and the worker that still has it; empty where none has."""
        return ("", "") if share.state is None else self._tokens.get(share.state, ("", ""))

    def _submit(self, share: Share, address: str, active: dict, quanta: int) -> None:
        token, home = self._of(share)
        arrays: Any = None
        if share.state is not None and home != address:
            arrays = share.state.arrays()
            token = token or "sent"
            if sum(np.asarray(value).nbytes for value in arrays.values()) > SMALL:
                arrays = self.client.scatter(arrays, workers=[address], hash=False)
        unit = Unit(self.job.key, share.first, share.count, quanta, token, self._seconds(address))
        # no other worker: Dask leaves tasks alone whose workers have all gone, also when others come; `_take_back` sees that
        future = self.client.submit(advance, unit, arrays, pure=False, workers=[address], key=f"radiosity-{uuid.uuid4().hex}")
        future.add_done_callback(lambda _: self.awake.set())
        active[future] = Active(share, address, time.monotonic())

    def _take_back(self, run: InParts, shares: list[Share], active: dict[Any, Active]) -> int:
        """Take the outcomes of units that have ended; return their number of lines."""
        lines = 0
        for future, one in list(active.items()):
            gone = one.address not in self._threads
            if future.status == "pending" and not gone:
                continue
            del active[future]
            outcome = self._outcome(future, one)
            if outcome is None:
                future.cancel()
                if gone:
                    self._died(one)
                continue
            self._deaths = 0
            self._take(one, outcome, run, shares)
            lines += outcome.lines
        return lines

    def _take(self, one: Active, outcome: Outcome, run: InParts, shares: list[Share]) -> None:
        """Put the state that a unit has come to in the place of the one before."""
        self.check(outcome.facts, outcome.address)
        state = run.whole.read(owned(outcome.arrays), replace(run.sizes, replicates=one.share.count))
        at = next(at for at, share in enumerate(shares) if share is one.share)
        shares[at] = Share(one.share.first, one.share.count, state, outcome.done)
        self._tokens[state] = (outcome.token, outcome.address)
        wall = time.monotonic() - one.begun
        self._sending.setdefault(one.address, deque(maxlen=LAST)).append(wall - outcome.seconds)
        for text in outcome.told:
            self.tell(text)
        if outcome.ended:
            raise Interrupted(outcome.ended)

    def _seconds(self, address: str) -> float:
        """Return the seconds of a worker's next unit."""
        return min(max(SECONDS, TIMES * min(self._sending.get(address, [0.0]))), MOST_SECONDS)

    def _outcome(self, future: Any, one: Active) -> Outcome | None:
        """Return what a unit has done; None where it must be handed out again."""
        from distributed import KilledWorker

        if future.status == "finished":
            return fetched(future)
        if future.status != "error":  # cancelled, or lost
            return None
        error = future.exception()
        if isinstance(error, Missing):
            if one.share.state is not None:
                self._tokens.pop(one.share.state, None)
            if str(error) == "job":
                self.register()
        elif not isinstance(error, (*FAILED_TO_COME, KilledWorker)):
            raise error
        return None

    def _died(self, one: Active) -> None:
        """Count a worker that died at a share, and end the run where share after share kills its worker."""
        self._deaths += 1
        if self._deaths >= DEATHS:
            raise DeviceError(
                f"{DEATHS} workers in a row died at this run, and no part came back in between; the last one was {one.address}. "
                "Their logs say why: often too little memory (take larger patches or fewer replicates)"
            )

    def check(self, there: dict[str, str], address: str) -> None:
        """Refuse a worker that would give other bits.

        Raises:
            DeviceError: it has other versions of packages, or another kind of processor.
        """
        here = facts()
        # by coherent=True a table of processors says what is fired; else any of them will do
        if getattr(getattr(self.job, "method", None), "coherent", False) is not True:
            here[INSTRUCTIONS] = there.get(INSTRUCTIONS, "")
        differs = [f"{name} {value} there, {here[name]} here" for name, value in there.items() if value != here[name]]
        if differs:
            raise DeviceError(f"worker {address} would give other bits: {'; '.join(differs)}. Install the same on all machines")

    def tell(self, text: str) -> None:
        """Warn, once for each text."""
        if text not in self._told:
            self._told.add(text)
            warnings.warn(text, RadiosityWarning, stacklevel=2)

    # ---- the job ---------------------------------------------------------------------------------------------------

    def register(self) -> None:
        """Bring the job, and those that it needs, to all workers."""
        for job in (*self.before, self.job):
            self.bring(job)

    def bring(self, job: Any) -> None:
        """Bring a job to all workers, those to come among them."""
        from .plugin import bring

        bring(self.client, job)

    def release(self) -> None:
        """Take the job off the workers."""
        with suppress(Exception):  # the scheduler may have gone
            if self.client.status == "running":
                self.client.unregister_worker_plugin(f"radiosity-{self.job.key}")
