"""How often the true value lies inside the stated intervals: ``python benchmarks/calibration.py [METHOD ...]``.

A run has eight replicates; its intervals are Student's. Replicates do not know of each other, so one process with a hundred times
as many holds a hundred runs of different seeds.
"""

import sys
import warnings
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

import radiosity as rd
from radiosity.engine.device import choose
from radiosity.engine.geometry import Geometry
from radiosity.engine.problem import Problem
from radiosity.engine.process import make

LEVELS = (0.9, 0.95, 0.99)
REPLICATES, SEEDS = 8, 100
BUDGETS = (16_000, 1_000_000)  # quanta of a replicate
REFERENCE = 300_000_000  # lines
BINS = (0, 3, 10, 30, 100, 300, 1000, 10_000, 100_000, np.inf)  # arrivals of a run's replicates together
METHODS = ("random-walk",)


@dataclass(frozen=True, eq=False)
class Case:
    """Patches, and their true irradiance (n_patches,)."""

    name: str
    patches: rd.Patches
    truth: np.ndarray


def cases() -> list[Case]:
    """Two furnaces, where the radiosity is one everywhere; the room and an open scene, by long runs of another seed."""
    found = []
    for reflectance in (0.5, 0.9):
        patches = rd.subdivide(rd.load_scene(f"labyrinth-{reflectance}"), cells=1)
        found.append(Case(f"labyrinth-{reflectance}", patches, np.ones(len(patches))))
    room = rd.load_scene("room")
    for name, patches in (("room", rd.subdivide(room, cells=3)), ("open", rd.subdivide(open_scene(room), cells=4))):
        long = rd.solve(patches, rays=REFERENCE, replicates=64, seed=987)
        print(f"{name}: {len(patches)} patches, the reference's error is {long.error:.3%}", flush=True)
        found.append(Case(name, patches, long.irradiance[:, 0]))
    return found


def open_scene(room: rd.Scene) -> rd.Scene:
    """No enclosure: a lit floor, a wall and a lamp, radiating on both sides, the backs duller."""
    keep = np.isin(room.surface, [room.names.index(name) for name in ("floor", "west wall", "light")])
    some = room.take(keep)
    return rd.Scene.from_arrays(
        some.vertices, some.faces, some.reflectance, some.emission, two_sided=True, back_reflectance=0.3,
        back_emission=np.zeros((1, 1)), surface=some.surface, names=some.names,
    )  # fmt: skip


def runs(case: Case, method: rd.Method, quanta: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """(SEEDS, REPLICATES, n_patches) irradiance, and (SEEDS, n_patches) arrivals (of methods that count them by replicate)."""
    problem = Problem.of(case.patches)
    process = make(Geometry(case.patches, choose("cpu")), problem, method, seed, REPLICATES * SEEDS)
    process.advance(quanta, lambda lines: None)
    state = process.capture()
    values, unit = process.tally.irradiance(problem, state, 0)
    found = np.asarray(values, np.float64).reshape(SEEDS, REPLICATES, -1) * (unit / case.patches.area)
    counts = state["arrivals"].reshape(SEEDS, REPLICATES, -1).sum(axis=1, dtype=np.int64)
    return found, counts


def covered(found: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """(SEEDS, n_patches) t statistics of the runs' means."""
    error = found.std(axis=1, ddof=1) / np.sqrt(found.shape[1])
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.abs(found.mean(axis=1) - truth) / error


def main(names) -> None:
    """Print coverage by arrivals."""
    from scipy.stats import t

    warnings.simplefilter("ignore")
    bounds = [t.ppf(0.5 + level / 2, REPLICATES - 1) for level in LEVELS]
    for case in cases():
        for name in names or METHODS:
            for quanta in BUDGETS:
                found, counts = runs(case, rd.method.resolve(name), quanta)
                apart = covered(found, case.truth)
                apart[np.isnan(apart)] = np.inf
                print(f"{case.name}, {name}, {quanta:,} quanta a replicate, {counts.sum() / SEEDS:,.0f} arrivals a run")
                for low, high in pairwise(BINS):
                    here = (counts >= low) & (counts < high)
                    if here.any():
                        shares = " ".join(f"{np.mean(apart[here] <= b):7.3%}" for b in bounds)
                        print(f"   {low:>7}.. {here.mean():7.2%} of patches {shares}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
