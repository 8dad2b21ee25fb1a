"""A progress bar on stderr: rays a second, error so far, time left."""

import sys
from contextlib import contextmanager
from math import isfinite

from .amounts import short


@contextmanager
def bar():
    """A callable for ``solve(progress=)``, or None where stderr is not a terminal."""
    from rich.console import Console

    console = Console(file=sys.stderr)
    if not console.is_terminal:
        yield None
        return
    from rich.progress import BarColumn, Progress, TextColumn

    columns = (TextColumn("{task.description}"), BarColumn(bar_width=30), TextColumn("{task.fields[facts]}"))
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("preparing", total=None, facts="")

        def advance(state) -> None:
            total, done = (None, 0.0) if state.fraction is None else (1.0, state.fraction)
            progress.update(task, description=state.message or "tracing", total=total, completed=done, facts=facts(state))

        yield advance


@contextmanager
def steps():
    """A callable (what, done, total) for work of many steps: a bar on a terminal, else nothing."""
    from rich.console import Console

    console = Console(file=sys.stderr)
    if not console.is_terminal:
        yield lambda what, done, total: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (BarColumn(bar_width=30), MofNCompleteColumn(), TimeElapsedColumn(), TextColumn("{task.description}"))
    with Progress(*columns, console=console, transient=True) as progress:
        task = progress.add_task("preparing", total=None)
        yield lambda what, done, total: progress.update(task, description=what, completed=done, total=total)


def facts(state) -> str:
    """Return a text such as ``stage 3, 12.3M rays, 21.4M/s, error 1.2 %, 8 s left``."""
    parts = [f"stage {state.stage + 1}", f"{short(state.rays)} rays", f"{short(state.rays_per_second)}/s"]
    if state.error is not None and isfinite(state.error):
        parts.append(f"error {100 * state.error:.2g} %")
    if state.seconds_left is not None:
        parts.append(f"{duration(state.seconds_left)} left")
    return ", ".join(parts)


def duration(seconds: float) -> str:
    """Return a text such as ``42 s``, ``3 min 05 s`` or ``2 h 10 min``."""
    whole = max(round(seconds), 0)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole // 60 % 60:02d} min"
