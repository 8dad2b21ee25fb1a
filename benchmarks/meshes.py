"""Discretisation errors of meshes that follow the light, and of even ones of the same number of patches: ``make bench-meshes``.

The light at points is gathered (`radiosity.measure`), from a solution on a mesh of its own. The error is the RMS over all sides
of faces, by area, of (reflectance x irradiance of the patch that holds a point) less (that of the point), relative to the RMS of
the latter. The noise of both is known from their replicates, and is taken out. Half of the points are drawn by area, half by area
times the square of reflected light, and each counts by the inverse of its density: the inside of a lamp is small, but so
bright that few points on it, or none, would decide the result. "elsewhere" are the points on surfaces that do not emit, and whose
reflected light is on average at most four times that of the scene. Intervals are those of one standard error, of other points
drawn in the same way (bootstrap). Even meshes have at most the number of patches asked for, those that follow the light the same.
Backs that let lines pass absorb them here, since a gather needs that what a point sees also sees the point.

python benchmarks/meshes.py [--scenes cornell-box room FILE.mgf] [--patches 5000 20000] [--times 2 4] [--points 6000]
"""

import argparse
import os
import warnings
from dataclasses import dataclass, replace

import numpy as np

import radiosity as rd
from radiosity.image.lookup import Lookup
from radiosity.tracing.first_hits import first_hits

LINES = 1000  # of a patch, and at least this many in all:
LEAST = 8_000_000
READ = 20_000  # patches of the solution that points read, beyond one for each side of a face
EACH = 5000  # lines of a point
BRIGHT = 4  # times the mean light: surfaces with more are not "elsewhere"
DRAWS = 400  # of the bootstrap
ROW = "  {:>9} {:>8} {:>22} {:>22} {:>7} {:>9}"


def used() -> float:
    """CPU seconds of this process so far."""
    times = os.times()
    return times.user + times.system


@dataclass(frozen=True, eq=False)
class Places:
    """Points on sides of faces, (count, 3) each, and how much each counts, (count,)."""

    points: np.ndarray
    normals: np.ndarray
    weights: np.ndarray

    @staticmethod
    def of(solution: rd.Solution, count: int, random) -> "Places":
        """Draw points on the patches of a solution, one cell a face: half by area, half also by the square of reflected light."""
        patches, scene = solution.patches, solution.patches.scene
        even = patches.area / patches.area.sum()
        bright = even * ((patches.reflectance * solution.irradiance) ** 2).sum(axis=1)
        density = (even + bright / bright.sum()) / 2
        at = random.choice(len(patches), count, p=density)
        u, v = random.random((2, count))
        over = ~scene.is_quad[patches.face[at]] & (u + v > 1)
        u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
        origin, first, second = (edge[patches.face[at]] for edge in scene.frames)
        return Places(origin + u[:, None] * first + v[:, None] * second, patches.normal[at], even[at] / density[at])


def patch_at(patches: rd.Patches, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return the patch that a line meets which comes to each point from a little in front of it, or -1."""
    above = 1e-4 * patches.scene.reach
    hits = first_hits(patches.scene, points + above * normals, -normals)
    found = Lookup(patches, np.zeros((len(patches), 1)), smooth=False).patch(hits)
    return np.where(np.abs(hits.distance - above) < 0.1 * above, found, -1)


def solved(patches: rd.Patches) -> rd.Solution:
    """Return a solution with little noise."""
    return rd.solve(patches, rays=max(LINES * len(patches), LEAST), seed=1)


def luminaires(solution: rd.Solution) -> np.ndarray:
    """Return which surfaces emit, or are much brighter than the scene, (n_surfaces,) bool."""
    patches, count = solution.patches, len(solution.patches.scene.names)
    light = (patches.reflectance * solution.irradiance).sum(axis=1)
    area, power, emitted = (
        np.bincount(patches.surface, patches.area * value, count) for value in (1, light, patches.emission.sum(axis=1))
    )
    return (emitted > 0) | (power * area.sum() > BRIGHT * power.sum() * area)


def even_mesh(scene: rd.Scene, count: int) -> rd.Patches:
    """Return the finest even mesh of at most ``count`` patches (``about`` leaves out faces that are not cut)."""
    low, high = 1, count
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if len(rd.subdivide(scene, about=middle)) <= count else (low, middle)
    return rd.subdivide(scene, about=low)


def errors(solution: rd.Solution, places: Places, truth: rd.Measurement, bright: np.ndarray) -> list[tuple[float, float, float]]:
    """Return the RMS error, relative, and its interval: of all points, and of those that are not on bright surfaces."""
    at = patch_at(solution.patches, places.points, places.normals)
    known = (at >= 0) & np.isfinite(truth.standard_error).all(axis=1)
    at, light, noise = at[known], truth.illuminance[known], truth.standard_error[known]
    rho, weights = solution.patches.reflectance[at], places.weights[known]
    square = (rho * (solution.irradiance[at] - light)) ** 2
    square -= rho**2 * (solution.irradiance_standard_error[at] ** 2 + noise**2)
    missed, there = weights * square.sum(axis=1), weights * ((rho * light) ** 2).sum(axis=1)
    random, found = np.random.default_rng(0), []
    for some in (np.arange(len(at)), np.flatnonzero(~bright[solution.patches.surface[at]])):
        drawn = [some, *(random.choice(some, len(some)) for _ in range(DRAWS))]
        values = np.array([np.sqrt(max(missed[one].sum(), 0.0) / there[one].sum()) for one in drawn])
        found.append((values[0], *np.percentile(values[1:], (16, 84))))
    return found


def compare(name: str, counts: list[int], times: list[float], points: int) -> None:
    """Print the rows of a scene."""
    scene = rd.load_scene(name, allow_outside=True)
    scene = replace(scene, back=np.where(scene.back == rd.Back.PASSES, rd.Back.ABSORBS, scene.back).astype(np.uint8))
    least = len(rd.subdivide(scene, cells=1))
    read = solved(rd.adapt(scene, least + READ, seed=7))
    places, bright = Places.of(read, points, np.random.default_rng(1)), luminaires(read)
    truth = rd.measure(read, rd.Sensors.of(places.points, places.normals), rays=EACH * points, seed=2)
    print(f"{name}: {scene.n_faces} faces, {least} sides", flush=True)
    print(ROW.format("points", "patches", "even", "follows", "ratio", "CPU s"))
    for count in [*(max(count, least) for count in counts), *(int(time * least) for time in times)]:
        even = even_mesh(scene, count)
        begun = used()
        follows = rd.adapt(scene, len(even))
        seconds = used() - begun
        found = [errors(solved(patches), places, truth, bright) for patches in (even, follows)]
        for what, *pair in zip(("all", "elsewhere"), *found, strict=True):
            told = [f"{one:.2%} ({low:.2%}-{high:.2%})" for one, low, high in pair]
            ratio = pair[0][0] / max(pair[1][0], 1e-9)
            print(ROW.format(what, len(even), *told, f"{ratio:.1f}", f"{seconds:.1f}"), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="+", default=["cornell-box", "room"])
    parser.add_argument("--patches", nargs="*", type=int, default=[5000, 20_000])
    parser.add_argument("--times", nargs="*", type=float, default=[], help="times the number of sides of the scene")
    parser.add_argument("--points", type=int, default=6000)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for scene_name in given.scenes:
        compare(scene_name, given.patches, given.times, given.points)
