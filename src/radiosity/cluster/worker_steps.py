"""What runs on workers of the steps of one run: ranges of its lines or walks, with counters of their own; sums come back."""

from typing import Any

import numpy as np

from ..algorithms.gather.elsewhere import GatherLines, Sums, trace_here
from ..algorithms.walks.launches import Chunks
from ..tally.shots import Landed, Shot, shoot_here
from .job import Job
from .worker import Brought, bring, keep, made, owned, taken

ALL = -1  # in place of a replicate: all of them


def shoot(key: str, unit: tuple[int, Shot]) -> Brought:
    """Fire a shot of iterations of a number of replicates; see `bring`."""
    return bring(key, lambda job: [shot_of(job, (unit[0], owned_of(unit[1])))])


def follow(key: str, unit: tuple[int, Chunks]) -> Brought:
    """Follow chunks of walks of a number of replicates; see `bring`."""
    return bring(key, lambda job: [walks_of(job, unit)])


def trace(key: str, unit: tuple[int, GatherLines]) -> Brought:
    """Trace lines of a gather of a number of replicates; see `bring`."""
    return bring(key, lambda job: [gather_of(job, (unit[0], owned_of(unit[1])))])


def shot_of(job: Job, unit: tuple[int, Shot]) -> Landed:
    """Return what a shot brings."""
    replicates, shot = unit
    place = (job.key, ALL, replicates)
    algorithm = taken(place) or made(job, 0, replicates)
    landed = shoot_here(algorithm.exchange.shooter, shot)
    keep(place, "", algorithm)
    return landed


def walks_of(job: Job, unit: tuple[int, Chunks]) -> tuple[Any, int]:
    """Return the sums of chunks of walks, and the number of their lines."""
    replicates, chunks = unit
    place = (job.key, ALL, replicates)
    algorithm, begun = taken(place) or (None, None)
    if algorithm is None:
        algorithm = made(job, 0, replicates)
        begun = algorithm.capture()
    algorithm.restore(begun)
    found = algorithm.follow_chunks(chunks)
    keep(place, "", (algorithm, begun))
    return found


def gather_of(job: Job, unit: tuple[int, GatherLines]) -> Sums:
    """Return the sums of lines of a gather."""
    replicates, part = unit
    place = (job.key, ALL, replicates)
    lines = taken(place) or made(job, 0, replicates).lines()
    found = trace_here(lines, part)
    keep(place, "", lines)
    return found


def owned_of(value: Any) -> Any:
    """Return a copy whose arrays are its own, see `owned`."""
    arrays = {name: one for name, one in vars(value).items() if isinstance(one, np.ndarray)}
    lists = {name: [np.array(x) for x in one] for name, one in vars(value).items() if isinstance(one, list)}
    return type(value)(**{**vars(value), **owned(arrays), **lists})
