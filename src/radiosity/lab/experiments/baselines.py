"""Experiment 6, the paper's first claim: more reliable, and less storage, than the methods that form the matrix."""

from pathlib import Path

import numpy as np

from ...patches import Patches, subdivide
from ...run.solve import solve
from .. import figures, report
from ..contest import ARMS, Entry, contest
from ..footprint import scene_of
from ..study import Claim, Protocol

TITLE = "Against the methods that form the matrix"
QUESTION = (
    "How much error is left after how many seconds, and in how much memory, by full matrix, progressive refinement and "
    "hierarchical radiosity, and by the best Monte Carlo methods, on the same patches?"
)
QUICK_SIZES, SIZES = (200,), (100, 1_000, 10_000, 100_000)
QUICK_REFERENCE, REFERENCE = 30_000_000, 1_000_000_000


def extras(protocol: Protocol, folder: Path) -> list[str]:
    """Return a figure, a table, and the claim."""
    quick = protocol.last < Protocol().last
    sizes, lines = (QUICK_SIZES, QUICK_REFERENCE) if quick else (SIZES, REFERENCE)
    found: dict[tuple[str, int], list[Entry]] = {}
    parts, rows = [], []
    for scene in ("room", "hall"):
        for about in sizes:
            patches = subdivide(scene_of(scene), about=about, powers_of_two=True)
            truth = solve(patches, rays=lines, seed=protocol.seed + 1)
            key = scene, len(patches)
            found[key] = contest(scene, about, patches, truth.irradiance, quick=quick)
            rows += [[*map(str, key), *_cells(entry)] for entry in found[key]]
            own = _own(truth, patches)
            parts.append(f"<p>Relative error of the reference of {scene} in {len(patches)} patches: {own:.2g}.</p>")
    path = folder / "experiment-6"
    figures.contests({key: [e for e in entries if e.ran] for key, entries in found.items()}, TITLE, path)
    heads = ["scene", "patches", "method", "run", "error", "seconds", "lines", "MiB beyond the scene"]
    return [report.figure(path), *parts, report.verdicts([_claim(found)]), report.table(heads, rows)]


def _cells(entry: Entry) -> list[str]:
    if not entry.ran:
        return [entry.arm, entry.label, "", "", "", ""]
    figures = f"{entry.error:.2%}", f"{entry.seconds:.2f}", f"{entry.lines:.3g}", f"{entry.memory / 2**20:.0f}"
    return [entry.arm, entry.label, *figures]


def _own(truth, patches: Patches) -> float:
    """Return the relative error of the reference irradiance itself, computed as the entries' errors are."""
    squares = patches.area @ truth.irradiance_standard_error**2, patches.area @ truth.irradiance**2
    return float(np.sqrt(squares[0] / squares[1]).max())


def _claim(found: dict[tuple[str, int], list[Entry]]) -> Claim:
    """Return the claim: less storage at equal error, and less error at equal time, of the random walk against each baseline."""
    wins, told = [], []
    for (scene, n), entries in found.items():
        runs = [entry for entry in entries if entry.ran]
        walks = [entry for entry in runs if entry.arm in ARMS and ARMS[entry.arm].monte_carlo]
        for name in dict.fromkeys(entry.arm for entry in runs if entry.arm in ARMS and not ARMS[entry.arm].monte_carlo):
            best = min((entry for entry in runs if entry.arm == name), key=lambda entry: entry.error)
            equal = [w for w in walks if w.error <= best.error]
            if not equal:
                wins.append(False)
                told.append(f"{scene}, {n} patches: no walk of these is as good as {name} ({best.error:.2%})")
                continue
            walk = min(equal, key=lambda entry: entry.seconds)
            wins.append(walk.seconds < best.seconds and walk.memory < best.memory)
            told.append(
                f"{scene}, {n} patches: {walk.arm} has {walk.error:.2%} after {walk.seconds:.2g} s in "
                f"{walk.memory / 2**20:.3g} MiB, {name} {best.error:.2%} after {best.seconds:.2g} s in "
                f"{best.memory / 2**20:.3g} MiB"
            )
    says = "Monte Carlo radiosity algorithms are more reliable and require significantly less storage than traditional ones"
    agrees = True if all(wins) else None if 2 * sum(wins) > len(wins) else False
    return Claim(says, agrees, f"{sum(wins)} of {len(wins)} comparisons. {'; '.join(told)}.")
