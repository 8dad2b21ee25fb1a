"""Running an experiment: every arm on every scene, each series kept in a file, so that an interrupted study goes on."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ..solution.whole import whole_file
from . import cases
from .experiments import module
from .kept import digest
from .measure import Series, measure
from .results import Results
from .study import Arm, Case, Protocol

Told = Callable[[str, int, int], None]
FIELDS = ("lines", "seconds", "area_weighted", "plain", "picture")


def run(number: int, protocol: Protocol, folder: Path, told: Told) -> Results:
    """Run an experiment and return its results.

    Args:
        folder: where series are kept, one file each; series that are there already are read.
        told: called with what is being done, how many series are done, and how many there are.
    """
    experiment = module(number)
    made = {scene: cases.maze(scene) if scene in cases.MAZES else cases.room() for scene in experiment.SCENES}
    folder.mkdir(parents=True, exist_ok=True)
    series, errors, total = {}, {}, len(made) * len(experiment.ARMS)
    for scene, case in made.items():
        for arm in experiment.ARMS:
            told(f"{scene}: {arm.name}", len(series), total)
            truth, error = _truth(case, arm.method.equation, protocol, folder)
            if error is not None:
                errors[scene, arm.method.equation] = error
            series[scene, arm.name] = _series(arm, case, truth, protocol, folder)
    told("done", total, total)
    return Results(series, errors)


def _series(arm: Arm, case: Case, truth: np.ndarray, protocol: Protocol, folder: Path) -> Series:
    kept = _kept(folder, "series", case, str(arm.method), protocol)
    if kept.exists():
        with np.load(kept, allow_pickle=False) as file:
            return Series(*(file[name] for name in FIELDS))
    found = measure(arm, case, truth, protocol)
    _write(kept, {name: getattr(found, name) for name in FIELDS})
    return found


def _truth(case: Case, equation: str, protocol: Protocol, folder: Path) -> tuple[np.ndarray, float | None]:
    if case.exact is not None:
        return case.exact, None
    kept = _kept(folder, "reference", case, equation, protocol)
    if kept.exists():
        with np.load(kept, allow_pickle=False) as file:
            return file["radiosity"], float(file["error"])
    radiosity, error = cases.reference(case, equation, protocol)
    _write(kept, {"radiosity": radiosity, "error": np.array(error)})
    return radiosity, error


def _kept(folder: Path, kind: str, case: Case, what: str, protocol: Protocol) -> Path:
    """Return the path of a file whose name has all that its content depends on."""
    name = digest([case.patches.scene.hash, case.patches.hash, what], protocol)
    return folder / f"{kind}-{case.name}-{name}.npz"


def _write(path: Path, arrays: dict[str, Any]) -> None:
    with whole_file(path) as file:
        np.savez(file, **arrays)
