"""Are the stated errors true? ``python benchmarks/calibration.py [METHOD ... | targets]`` prints, for four scenes and two
budgets, how often the true value lies inside Student's intervals of eight replicates, and for the default method whether a
target error is reached, and how many more lines it took than were needed.
"""

import sys
import warnings
from dataclasses import replace

import numpy as np

import radiosity as rd
from radiosity.lab import cases
from radiosity.lab.calibration import LEVELS, coverage
from radiosity.lab.study import Arm, Case
from radiosity.solution.errors import relative_error

SEEDS, VISITED = 100, 100  # runs; arrivals of the patches that count as well visited
BUDGETS = (16_000, 500_000)  # lines of a replicate
REFERENCE = 400_000_000
METHODS = ("random-walk", "sobol", "random", "particle-tracing", "stochastic-jacobi", "global-multipath-first-shot")
TARGETS = (
    ("labyrinth-0.5", 1, 0.0018, None),
    ("labyrinth-0.5", 1, 0.001, None),
    ("room", 3, 0.004, None),
    ("room", 3, 0.0025, None),
    ("cornell-box", 3, 0.005, None),
    ("cornell-box", 3, 0.003, None),
    ("room", 3, 0.0012, "surface:floor"),
)
RUNS, SLOPE = 100, 0.6


def known() -> list[tuple[Case, dict[str, np.ndarray]]]:
    """Cases, and the true radiosity by equation: two furnaces, and long runs of another seed for the room and for open plates."""
    found = []
    for name in ("labyrinth-0.5", "labyrinth-0.9"):
        case = cases.maze(name)
        found.append((case, dict.fromkeys(("discrete", "continuous"), cases.ones(case))))
    for case in (cases.room(3), cases.plates()):
        truth = {}
        for equation in ("discrete", "continuous"):
            long = rd.solve(case.patches, rd.Method(equation=equation), rays=REFERENCE, replicates=64, seed=987)
            print(f"{case.name}, {equation}: {len(case.patches)} patches, the reference's error is {long.error:.3%}", flush=True)
            truth[equation] = long.radiosity[:, 0]
        found.append((case, truth))
    return found


def named(name: str) -> rd.Method:
    """A preset, or the default with other numbers."""
    return rd.method.resolve(name) if name in rd.PRESETS else replace(rd.Method(), numbers=name)


def targets() -> None:
    """Runs that go on until their error is reached, against the truth."""
    for name, cells, target, of in TARGETS:
        patches = rd.subdivide(rd.load_scene(name), cells=cells)
        truth = np.ones((len(patches), 1))
        if not name.startswith("labyrinth"):
            truth = rd.solve(patches, "random-walk", rays=REFERENCE, replicates=32, seed=987).irradiance
        rows = slice(None) if of is None else patches.surface == patches.scene.names.index(of.removeprefix("surface:"))
        true, errors, lines = (patches.reflectance[rows], truth[rows]), [], []
        for seed in range(RUNS):
            solution = rd.solve(patches, "random-walk", error=target, error_of=of, seed=seed)
            errors.append(relative_error(*true, (solution.irradiance - truth)[rows], patches.area[rows]))
            lines.append(solution.rays)
        # a run of as many lines as all these would have its error below this in 95 % of cases: so many lines were needed
        usual = float(np.quantile(errors, 0.95))
        needed = (usual / target) ** (1 / SLOPE)
        print(
            f"{name} {of or ''} {target:.2%}: reached in {np.mean(np.array(errors) <= target):.0%} of {RUNS} runs; RMS of the "
            f"true errors {np.sqrt(np.mean(np.square(errors))) / target:.2f} of the target; {np.median(lines):,.0f} lines, "
            f"{1 / needed:.2f} times those needed",
            flush=True,
        )


def main(names) -> None:
    """Print both tables."""
    warnings.simplefilter("ignore")
    for case, truth in known() if names != ["targets"] else []:
        for name in names or METHODS:
            method = named(name)
            for lines in BUDGETS:
                arm = Arm(name, method, name)
                row = coverage(arm, case, truth[method.equation], 1, lines=lines, seeds=SEEDS, visited=VISITED)
                shares = "  ".join(
                    f"{level:.0%}: {100 * share:5.1f} ± {100 * error:.1f}"
                    for level, (share, error) in zip(LEVELS, row.covered, strict=True)
                )
                print(f"{case.name:<14} {name:<28} {lines:>9,} lines  {row.visited:4.0%} of patches  {shares}", flush=True)
    if names in ([], ["targets"]):
        targets()


if __name__ == "__main__":
    main(sys.argv[1:])
