"""The memory of workers: a part that does not fit is refused before it begins, by an error that names the worker."""

from typing import Any

from ..device import memory
from ..errors import MethodError
from ..method import Baseline
from ..run.memory_estimate import memory_needed
from .job import Job


def check(job: Job, replicates: int) -> None:
    """Refuse a part of a run that will not fit in the memory of the worker whose task this is; elsewhere nothing is checked.

    Raises:
        MethodError: the estimate is larger than what is left here.
    """
    if isinstance(job.method, Baseline):
        return
    problem = job.problem
    lines = None if job.lines is None else job.lines * replicates
    wanted = memory_needed(job.method, problem.patches, problem.groups.n_groups, replicates, lines)
    what = f"{job.method} on {len(problem.patches):,} patches in {replicates} replicates"
    refuse(wanted, what, "take larger patches, more workers")


def refuse(wanted: float, what: str, way_out: str) -> None:
    """Refuse what will not fit in the memory of the worker whose task this is; elsewhere nothing is checked.

    Raises:
        MethodError: more bytes are wanted than are left here.
    """
    from distributed import get_worker

    try:
        worker = get_worker()
    except ValueError:  # this is the driver, which was checked when the run began
        return
    there = left(worker)
    if wanted > there:
        raise MethodError(
            f"worker {worker.address} has too little memory: {what} would take about {memory.size(wanted)}, and a run may take "
            f"{memory.size(there)} there; {way_out}, or a machine with more memory (there, "
            f"{memory.VARIABLE} sets the limit, and --memory-limit that of Dask)"
        )


def left(worker: Any) -> float:
    """Return the bytes that a part may take: as of a run of one machine, and no more than Dask's limit leaves."""
    room, most = memory.room(), worker.memory_manager.memory_limit
    return room if not most else min(room, max(most - worker.monitor.get_process_memory(), 0.0))
