"""A run on a cluster, from the connection to the end."""

import warnings
from collections.abc import Callable
from typing import Any

from ..algorithms.base import AbstractAlgorithm
from ..algorithms.in_parts import InParts, in_parts
from ..errors import DeviceError, RadiosityWarning, result_kept
from ..run.memory_estimate import lines_of
from ..run.part import together
from ..run.record import Record
from ..run.result import R
from ..run.run import Run
from .connect import connected
from .crew import DaskCrew
from .gpus import tell_of_shared
from .job import Job
from .steps import cut


def solve(cluster: Any, prepared: Callable[[], Run[R]]) -> R:
    """Return the result of a run whose parts workers bring forward.

    Args:
        cluster: an address, "local:N" or a client, see `connected`.
        prepared: gives the run, once the cluster is there.

    Raises:
        DeviceError: as of `connected`; workers die again and again, or have other versions of packages; or the scheduler was
            lost before the first stage was complete.
    """
    with connected(cluster) as client:
        run = prepared()
        lines = lines_of(run.method, run.budget, run.part.replicates)
        each = None if lines is None else lines / run.part.replicates
        crew = DaskCrew(client, Job(run.problem, run.method, run.part.seed, run.device.name, each), together(run.method))
        tell_of_shared(client, run.device.name)
        crew.stopping = lambda: run.stop.asked
        crew.register()
        try:
            run.spread = lambda whole: _spread(whole, crew, run)
            solution = run.solve()
        except KeyboardInterrupt:
            if crew.lost:
                raise DeviceError(f"{crew.lost}, and no stage was complete; {_next(run)}") from None
            raise
        finally:
            crew.release()
        if crew.lost:
            with result_kept():
                warnings.warn(f"{crew.lost}: the run has ended before its end; {_next(run)}", RadiosityWarning, stacklevel=2)
        return solution


def _spread(whole: AbstractAlgorithm, crew: DaskCrew, run: Run) -> AbstractAlgorithm:
    """Return the algorithm of a run: in parts of its replicates, or in cut steps where there are more workers than those."""
    begun = run.resume is not None and in_parts(run.resume.state)
    parts = 1 if crew.together else whole.replicates
    if not begun and not getattr(run.method, "coherent", False) and len(crew.present()) > parts and cut(whole, crew):
        return whole
    return InParts(whole, crew, waits=not isinstance(run.record, Record))


def _next(run: Run) -> str:
    keeper = run.checkpoint
    what = "the solution" if keeper is None or not keeper.written else f"the checkpoint {keeper.path}"
    return f"{what} goes on (resume), with another cluster or without one"
