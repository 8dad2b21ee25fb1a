"""Monte Carlo methods and baselines on the same patches: error, seconds and memory of each run."""

import math
from dataclasses import dataclass

import numpy as np

from ..patches import Patches
from .footprint import footprints


@dataclass(frozen=True)
class Contestant:
    """A method, and the options that are varied.

    Attributes:
        method: a preset's name.
        runs: label and options of ``radiosity.solve``, the cheapest first; a quick study takes ``few`` of them.
        most: patches; with more it would take too long, and its row then says so.
        monte_carlo: True where it forms no matrix.
    """

    method: str
    runs: tuple[tuple[str, dict], ...]
    most: int
    monte_carlo: bool = False
    few: int = 2


@dataclass(frozen=True)
class Entry:
    """A run, or the reason why there is none (then ``error`` is NaN and ``label`` is the reason).

    Attributes:
        error: area-weighted RMS of the irradiance less the true one, divided by that of the true one; the worst band.
        seconds, lines, memory: see `Footprint`.
    """

    arm: str
    label: str
    error: float = math.nan
    seconds: float = 0.0
    lines: int = 0
    memory: float = 0.0

    @property
    def ran(self) -> bool:
        """True where there is a run."""
        return not math.isnan(self.error)


def _varied(name: str, values, label: str, **others) -> tuple[tuple[str, dict], ...]:
    return tuple((label.format(value), {name: value, **others}) for value in values)


LINES = tuple((f"{rays:.0e} lines", {"rays": rays}) for rays in (100_000, 1_000_000, 10_000_000, 100_000_000))
EPSILONS = (1e-3, 1e-4, 1e-5, 1e-6)
BOTH_ENDS = tuple((label, {**options, "estimator": "bidirectional"}) for label, options in LINES)
ARMS = {
    "random walk": Contestant("random-walk", LINES, 10**9, True, 3),
    "stochastic Jacobi, control variate, both ends": Contestant("stochastic-jacobi-control-variate", BOTH_ENDS, 10**9, True, 3),
    "full matrix, polygons": Contestant("full-matrix", _varied("samples", (4, 16, 64), "{} lines a pair"), 3_000),
    "full matrix, hemicubes": Contestant("full-matrix-hemicube", _varied("resolution", (32, 64, 128), "{} pixels"), 15_000),
    "progressive, hemicubes": Contestant(
        "progressive-refinement", _varied("resolution", (32, 64, 128), "{} pixels, 60 s at most", seconds=60), 10**9
    ),
    "hierarchical": Contestant("hierarchical", _varied("epsilon", EPSILONS, "epsilon {:g}"), 15_000, few=3),
    "hierarchical, error control": Contestant(
        "hierarchical-error-control", _varied("epsilon", EPSILONS[:3], "epsilon {:g}", refinement="error-power"), 15_000
    ),
}


def contest(scene: str, about: int, patches: Patches, truth: np.ndarray, *, quick: bool) -> list[Entry]:
    """Run every contestant on a scene that is cut into about ``about`` patches.

    Args:
        truth: (n_patches, n_bands) irradiance to compare with.
    """
    entries = []
    for name, arm in ARMS.items():
        if len(patches) > arm.most:
            entries.append(Entry(name, f"not run: it would take too long with more than {arm.most} patches"))
            continue
        runs = list(arm.runs[: arm.few] if quick else arm.runs)
        found = footprints(scene, about, arm.method, runs, warm=arm.monte_carlo)
        if isinstance(found, str):
            entries.append(Entry(name, f"refused: {found}"))
            continue
        for run in found:
            error = _error(run.irradiance, truth, patches.area)
            entries.append(Entry(name, run.label, error, run.seconds, run.lines, run.memory))
    return entries


def _error(found: np.ndarray, truth: np.ndarray, area: np.ndarray) -> float:
    return float(np.sqrt((area @ (found - truth) ** 2) / (area @ truth**2)).max())
