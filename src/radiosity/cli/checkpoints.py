"""The checkpoint of a run: where it is written, and when it is removed."""

import warnings
from contextlib import suppress
from pathlib import Path

from ..errors import OutputError, RadiosityWarning
from . import interrupts
from .streams import say

HALF_A_MINUTE = 30.0  # seconds from which a run is long; also the time between two checkpoints that nobody asked for


def chosen(path: Path | None, off: bool, outputs, method, resume: Path | None, save=None):
    """The checkpoint that was named, or one beside the first output: ``box.glb`` -> ``box.checkpoint.npz``; or None.

    Args:
        save: writes the results of the run; default: solutions.

    Raises:
        OutputError: the one that was named cannot be written, or is an output too.
        MethodError: no run can continue from it.
    """
    from ..run.checkpoint import Checkpoint, resumable, save_solution

    save = save_solution if save is None else save
    if path is not None:
        if off:
            raise OutputError(f"--checkpoint {path} and --no-checkpoint exclude each other; give one")
        if _place(path) in map(_place, outputs):
            raise OutputError(f"{path} is named twice; give the checkpoint a name of its own, since it is removed in the end")
        keeper = Checkpoint(path, save=save)
        keeper.check(method)
        _point_at_earlier(keeper.path, resume)
        return keeper
    if off or not outputs or not resumable(method):
        return None
    beside: Path = outputs[0].with_name(f"{outputs[0].stem}.checkpoint.npz")
    if _place(beside) in map(_place, outputs):
        return None
    keeper = Checkpoint(beside, HALF_A_MINUTE, save)
    try:
        keeper.check(method)
    except OutputError:  # nobody asked for it
        return None
    _point_at_earlier(keeper.path, resume)
    return keeper


def _point_at_earlier(path: Path, resume: Path | None) -> None:
    """Warn that this run will replace an earlier checkpoint which it does not continue."""
    if path.exists() and (resume is None or _place(resume) != _place(path)):
        warnings.warn(
            f"{path}: the checkpoint of an earlier run, which --resume {path} goes on from; one of this run takes its place "
            "after half a minute",
            RadiosityWarning,
            stacklevel=3,
        )


def finish(keeper, solution, outputs, *, named: bool, resume: Path | None) -> str | None:
    """Remove the checkpoint that is no longer needed, or return the file to continue from; called when outputs are written."""
    if keeper is None:
        return None
    from ..run.held import held

    path, stopped = keeper.path, solution.status in ("interrupted", "not reached")
    elsewhere = not named and any(output.suffix.lower() == ".npz" for output in outputs)
    if stopped and not elsewhere:
        return str(path) if keeper.written else None
    if (keeper.written or (resume is not None and _place(resume) == _place(path))) and not held(path):
        with suppress(OSError):
            path.unlink()
    return None


def _place(path: Path) -> Path:
    with suppress(OSError, RuntimeError, ValueError):
        return Path(path).resolve()
    return Path(path)


def left_behind(keeper) -> int:
    """Answer an interruption that came before the outputs were written: say what goes on, and return the exit status."""
    interrupts.answer()
    say("interrupted", f"stopped before the end; --resume {keeper.path} goes on from there")
    return interrupts.status()
