"""What runs on workers: a part of a run goes on for a few seconds, and its state comes back."""

import time
import uuid
import warnings
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..algorithms.base import Interrupted
from ..algorithms.firing.elsewhere import Hits, Lines
from ..algorithms.firing.for_others import fire_here
from ..algorithms.firing.own_rows import OwnRows, fire_own
from ..device.backend import frozen, threads
from ..device.turn import turn
from .job import Job, facts
from .post import WorkerPost
from .room import check

KEPT = 2  # algorithms that stay on a worker between two units, so that their states need not be sent

_jobs: dict[str, Any] = {}
_live: OrderedDict[tuple[str, int, int], tuple[str, Any]] = OrderedDict()


class Missing(Exception):
    """The worker lacks the job, or the state that a unit goes on from."""


class _Enough(Interrupted):
    """The time of a unit is over."""


@dataclass(frozen=True, eq=False)
class Unit:
    """What a worker is to do: bring replicates of a run forward within a stage.

    Attributes:
        job: the key of the job.
        first, count: the replicates.
        quanta: N at the end of the stage.
        token: of the state that it goes on from; "" for the beginning.
        seconds: after which it stops.
    """

    job: str
    first: int
    count: int
    quanta: int
    token: str
    seconds: float


@dataclass(frozen=True, eq=False)
class Outcome:
    """What a unit has done.

    Attributes:
        arrays: of the state.
        token: of that state.
        lines: traced since the state before.
        done: True where the stage is complete.
        seconds: of work.
        ended: why the algorithm itself ended the stage early, or "".
        told: warnings.
        address: of the worker.
        facts: of its packages.
    """

    arrays: dict[str, np.ndarray]
    token: str
    lines: int
    done: bool
    seconds: float
    ended: str
    told: tuple[str, ...]
    address: str
    facts: dict[str, str]


def put(job: Any) -> None:
    """Keep a job for units to come."""
    _jobs[job.key] = job


def job_of(key: str) -> Any:
    """Return a job that was kept.

    Raises:
        Missing: this worker has no such job.
    """
    if key not in _jobs:
        raise Missing("job")
    return _jobs[key]


def drop(key: str) -> None:
    """Forget a job, and free what was made of it."""
    _jobs.pop(key, None)
    for one in [one for one in _live if one[0] == key]:
        _live.pop(one, None)


@dataclass(frozen=True, eq=False)
class Brought:
    """What lines between two barriers brought, and the time that they took.

    Attributes:
        what: of lines of a wavefront `Hits`, of sensors `Sums`.
        seconds: of work.
        address: of the worker.
        facts: of its packages.
    """

    what: list
    seconds: float
    address: str
    facts: dict[str, str]


def fire(key: str, lines: list[Lines]) -> Brought:
    """Fire lines of a wavefront; see `bring`."""
    return bring(key, lambda job: list(fire_all(job, [owned_lines(one) for one in lines])))


def fire_own_rows(key: str, unit: tuple[OwnRows, str, list[str]]) -> Brought:
    """Fire lines of own rows, and tell other workers their hits, until nothing is due anywhere (`own_rows`).

    Args:
        unit: the task, the key of the work that the workers do together, and the addresses of these.

    Raises:
        Missing: this worker has no such job.
    """
    from distributed import get_worker

    job = job_of(key)
    (address, count), seconds, (task, work, addresses) = _here(), 0.0, unit
    with turn(), threads(count, back=False):
        counters = _counters(job, task.replicate)
        phase = frozen(counters.targets.phase).copy()

    def fire_some(lines: Lines) -> Hits:
        nonlocal seconds
        begun = time.perf_counter()
        with turn(), threads(count, back=False):  # and not while it waits: workers may be threads of one process
            hits = fire_here(counters, lines)
        seconds += time.perf_counter() - begun
        return hits

    post = WorkerPost(get_worker(), work, task.own, addresses)
    first = None if task.lines is None else owned_lines(task.lines)
    try:
        hits = fire_own(replace(task, lines=first), counters.source, phase, fire_some, post)
    finally:
        post.close()
    keep((key, task.replicate, 0), "", counters)
    return Brought([hits], seconds, address, facts())


def sense(key: str, counts: tuple[np.ndarray, np.ndarray]) -> Brought:
    """Trace lines of sensors; see `bring`."""
    return bring(key, lambda job: [job.sums(*(np.array(one) for one in counts))])


def bring(key: str, act: Callable[[Any], list]) -> Brought:
    """Return what a job makes of a unit, on the worker's threads.

    Raises:
        Missing: this worker has no such job.
    """
    begun, job = time.perf_counter(), job_of(key)
    address, count = _here()
    with turn(), threads(count, back=False):
        what = act(job)
    return Brought(what, time.perf_counter() - begun, address, facts())


def fire_all(job: Job, lines: list[Lines]) -> Iterator[Hits]:
    """Yield the hits of lines, one replicate after the other; counters of some replicates stay for later wavefronts."""
    for one in lines:
        counters = _counters(job, one.replicate)
        yield fire_here(counters, one)
        keep((job.key, one.replicate, 0), "", counters)


def _counters(job: Job, replicate: int) -> Any:
    """Return counters of a replicate, which are no one else's until they are kept."""
    counters = taken((job.key, replicate, 0))
    return made(job, replicate, 1).counters if counters is None else counters


def made(job: Job, first: int, count: int) -> Any:
    """Return a new algorithm of some replicates, where there is memory for it."""
    check(job, count)
    return job.algorithm(first, count)


def taken(place: tuple[str, int, int]) -> Any:
    """Return what a place holds, which is no one else's until it is kept again; None where it holds nothing."""
    return _live.pop(place, ("", None))[1]


def owned_lines(lines: Lines) -> Lines:
    """Return a copy, see `owned`."""
    arrays = {name: value for name, value in vars(lines).items() if isinstance(value, np.ndarray)}
    return replace(lines, **owned(arrays))


def keep(place: tuple[str, int, int], token: str, kept: Any) -> None:
    """Keep an algorithm, counters or what else a place holds, and forget the oldest."""
    _live[place] = (token, kept)
    while len(_live) > KEPT:
        _live.popitem(last=False)


def owned(arrays: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return copies of arrays that came over the network: those may be misaligned, read-only or shared."""
    return {name: np.array(value, order="C") for name, value in arrays.items()}


def advance(unit: Unit, arrays: Mapping[str, np.ndarray] | None) -> Outcome:
    """Bring a unit's replicates forward, until the stage or the time ends.

    Args:
        arrays: the state that it goes on from; None where it begins, or where the worker still has it.

    Raises:
        Missing: this worker has no such job, or no such state.
    """
    begun, lines = time.perf_counter(), 0
    job = job_of(unit.job)

    def swept(count: int) -> None:
        nonlocal lines
        lines += count
        if time.perf_counter() - begun > unit.seconds:
            raise _Enough

    address, count = _here()
    with turn(), threads(count, back=False), warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        algorithm = _ready(job, unit, arrays)
        done, ended = False, ""
        try:
            algorithm.advance(unit.quanta, swept)
            done = True
        except _Enough:
            pass
        except Interrupted as reason:
            ended = str(reason)
        state, token = algorithm.capture().arrays(), uuid.uuid4().hex
        keep((unit.job, unit.first, unit.count), token, algorithm)
    texts = tuple(dict.fromkeys(str(one.message) for one in told))
    return Outcome(state, token, lines, done, time.perf_counter() - begun, ended, texts, address, facts())


def _ready(job: Job, unit: Unit, arrays: Mapping[str, np.ndarray] | None) -> Any:
    """Return the algorithm of a unit, in the state that it goes on from."""
    token, algorithm = _live.pop((unit.job, unit.first, unit.count), ("", None))
    if unit.token and token == unit.token:
        return algorithm
    if unit.token and arrays is None:
        raise Missing("state")
    algorithm = made(job, unit.first, unit.count)
    if arrays is not None:
        algorithm.restore(algorithm.read(owned(arrays), algorithm.sizes))
    return algorithm


def _here() -> tuple[str, int]:
    """Return address and threads of the worker whose task this is: Dr.Jit would take all cores of the machine."""
    from distributed import get_worker

    worker = get_worker()
    return worker.address, worker.state.nthreads
