"""Do intervals of surfaces hold the truth? ``python benchmarks/calibration_surfaces.py [METHOD ...]`` prints, for two scenes and
two budgets, how often 95 % intervals of the mean of a surface hold that of a run of the same method with 40 times as many lines.
In brackets: without the biases that the method states. A method is a preset, with ``/linear`` or ``/quadratic`` for a basis. A
quarter of an hour.
"""

import sys
import warnings
from dataclasses import replace

import numpy as np

import radiosity as rd

SEEDS, MORE, REPLICATES = 16, 40, 16  # runs; of lines in the reference, and its replicates
BUDGETS = (60_000, 600_000)  # lines
SCENES = {"cornell-box": 3, "room": 3}  # cells
METHODS = (
    "random-walk",
    "gather",
    "gather/linear",
    "gather/quadratic",
    "global-form-factors",
    "local-form-factors",
    "transillumination",
)
OF_NO_PRESET = {"local-form-factors": rd.Method(order="matrix")}


def named(text: str) -> rd.Method:
    """The method of a name and a basis."""
    name, _, basis = text.partition("/")
    method = OF_NO_PRESET[name] if name in OF_NO_PRESET else rd.method.resolve(name)
    return replace(method, basis=basis) if basis else method


def held(solutions: list[rd.Solution], known: np.ndarray) -> tuple[float, float]:
    """The shares of intervals that hold what is known, of all surfaces and of the worst."""
    ends = [solution.surface_interval() for solution in solutions]
    found = np.mean([(low <= known) & (known <= high) for low, high in ends], axis=0)[known > 0]
    return float(found.mean()), float(found.min())


def main(names) -> None:
    """Print a row for each scene, method and budget."""
    warnings.simplefilter("ignore")
    for scene, cells in SCENES.items():
        patches = rd.subdivide(rd.load_scene(scene), cells=cells)
        for name in names or METHODS:
            for lines in BUDGETS:
                method = named(name)
                low, high = rd.solve(patches, method, rays=MORE * lines, replicates=REPLICATES, seed=4321).surface_interval()
                runs = [rd.solve(patches, method, rays=lines, seed=seed) for seed in range(SEEDS)]
                (share, worst), (bare, least) = (
                    held(each, (low + high) / 2) for each in (runs, [replace(run, side_bias=None) for run in runs])
                )
                of_all, of_worst = f"{share:6.1%} ({bare:.1%})", f"{worst:4.0%} ({least:.0%})"
                print(f"{scene:<12} {name:<22} {lines:>8,} lines  {of_all}  the worst surface {of_worst}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
