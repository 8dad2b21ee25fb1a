"""Discretisation errors of meshes that follow the light, and of even ones of the same number of patches: ``make bench-meshes``.

Points are drawn evenly over all sides of faces. The light at each is gathered (`radiosity.measure`), from a solution on a mesh of
its own. The error is the RMS of (reflectance x irradiance of the patch that holds the point) less (that of the point), relative
to the RMS of the latter. The noise of both is known from their replicates, and is taken out. Backs that let lines pass absorb
them here, since a gather needs that what a point sees also sees the point.

python benchmarks/meshes.py [--scenes cornell-box room FILE.mgf] [--patches 5000 20000] [--points 1500]
"""

import argparse
import os
import warnings
from dataclasses import replace

import numpy as np

import radiosity as rd
from radiosity.image.lookup import Lookup
from radiosity.tracing.first_hits import first_hits

LINES = 1000  # of a patch, and at least this many in all:
LEAST = 8_000_000
READ = 20_000  # patches of the solution that points read, beyond one for each side of a face
EACH = 5000  # lines of a point
ROW = "  {:>8} {:>9} {:>9} {:>7} {:>9}"


def used() -> float:
    """CPU seconds of this process so far."""
    times = os.times()
    return times.user + times.system


def places(scene: rd.Scene, count: int, random) -> tuple[np.ndarray, np.ndarray]:
    """Return points on sides of faces, and the normals of these sides, (count, 3) each."""
    sides = rd.subdivide(scene, cells=1)
    side = random.choice(len(sides), count, p=sides.area / sides.area.sum())
    u, v = random.random((2, count))
    over = ~scene.is_quad[sides.face[side]] & (u + v > 1)
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    origin, first, second = (edge[sides.face[side]] for edge in scene.frames)
    return origin + u[:, None] * first + v[:, None] * second, sides.normal[side]


def patch_at(patches: rd.Patches, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Return the patch that a line meets which comes to each point from a little in front of it, or -1."""
    above = 1e-4 * patches.scene.reach
    hits = first_hits(patches.scene, points + above * normals, -normals)
    found = Lookup(patches, np.zeros((len(patches), 1)), smooth=False).patch(hits)
    return np.where(np.abs(hits.distance - above) < 0.1 * above, found, -1)


def solved(patches: rd.Patches) -> rd.Solution:
    """Return a solution with little noise."""
    return rd.solve(patches, rays=max(LINES * len(patches), LEAST), seed=1)


def error(solution: rd.Solution, points: np.ndarray, normals: np.ndarray, truth: rd.Measurement) -> float:
    """Return the RMS error, relative."""
    at = patch_at(solution.patches, points, normals)
    known = (at >= 0) & np.isfinite(truth.standard_error).all(axis=1)
    at, light, noise = at[known], truth.illuminance[known], truth.standard_error[known]
    rho = solution.patches.reflectance[at]
    square = (rho * (solution.irradiance[at] - light)) ** 2
    square -= rho**2 * (solution.irradiance_standard_error[at] ** 2 + noise**2)
    return float(np.sqrt(max(square.sum(), 0.0) / ((rho * light) ** 2).sum()))


def compare(name: str, counts: list[int], points: int) -> None:
    """Print the rows of a scene."""
    scene = rd.load_scene(name, allow_outside=True)
    scene = replace(scene, back=np.where(scene.back == rd.Back.PASSES, rd.Back.ABSORBS, scene.back).astype(np.uint8))
    least = len(rd.subdivide(scene, cells=1))
    where, normals = places(scene, points, np.random.default_rng(1))
    read = solved(rd.adapt(scene, least + READ, seed=7))
    truth = rd.measure(read, rd.Sensors.of(where, normals), rays=EACH * points, seed=2)
    print(f"{name}: {scene.n_faces} faces, {least} sides", flush=True)
    print(ROW.format("patches", "even", "follows", "ratio", "CPU s"))
    for count in counts or [2 * least]:
        even = rd.subdivide(scene, about=count)
        begun = used()
        follows = rd.adapt(scene, len(even))
        seconds = used() - begun
        errors = [error(solved(patches), where, normals, truth) for patches in (even, follows)]
        ratio = errors[0] / max(errors[1], 1e-9)
        shares = [f"{value:.2%}" for value in errors]
        print(ROW.format(len(even), *shares, f"{ratio:.1f}", f"{seconds:.1f}"), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="+", default=["cornell-box", "room"])
    parser.add_argument("--patches", nargs="+", type=int, default=[5000, 20_000])
    parser.add_argument("--points", type=int, default=1500)
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for scene_name in given.scenes:
        compare(scene_name, given.patches, given.points)
