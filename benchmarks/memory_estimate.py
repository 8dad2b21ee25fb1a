"""Memory of runs at their peak, and as `run.memory_estimate` expects it.

python benchmarks/memory_estimate.py [METHOD ...]
"""

import sys

import radiosity as rd
from radiosity.lab.footprint import footprints, scene_of
from radiosity.problem.model import Problem
from radiosity.run.memory_estimate import memory_needed

METHODS = ("random-walk", "particle-tracing", "stochastic-jacobi", "global-multipath", "transillumination", "global-form-factors")
SIZES, REPLICATES, RAYS = (15_000, 200_000), (1, 8), 4_000_000
ROW = "{:<22} {:<12} {:>8} {:>10} {:>9} {:>9} {:>6}"


def compare(methods) -> None:
    """One row a method, scene, size and number of replicates, each from a process of its own; last, expected over measured."""
    print(ROW.format("method", "scene", "patches", "replicates", "MiB", "expected", "ratio"))
    for method in methods:
        for scene in ("room", "cornell-box"):
            for about in SIZES:
                for replicates in REPLICATES:
                    taken = footprints(scene, about, method, [("run", {"rays": RAYS, "replicates": replicates})], warm=False)
                    if isinstance(taken, str):
                        print(method, scene, about, replicates, taken, flush=True)
                        continue
                    patches = rd.subdivide(scene_of(scene), about=about, powers_of_two=True)
                    groups = Problem.of(patches).groups.n_groups
                    chosen = rd.method.resolve(method)
                    assert isinstance(chosen, rd.Method)
                    expected = memory_needed(chosen, patches, groups, replicates, RAYS)
                    measured = taken[0].memory
                    numbers = (f"{measured / 2**20:.0f}", f"{expected / 2**20:.0f}", f"{expected / measured:.2f}")
                    print(ROW.format(method, scene, len(patches), replicates, *numbers), flush=True)


if __name__ == "__main__":
    compare(sys.argv[1:] or METHODS)
