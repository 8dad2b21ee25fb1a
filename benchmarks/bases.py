"""Errors of light that is constant, linear or quadratic on patches, on even meshes and on ones that follow the light.

A mesh that follows the light is made for each basis (`adapt(basis=)`).

The light at points is gathered, as in benchmarks/meshes.py; "sampling" is the part of the error that the replicates tell.
Constants have four times the patches of polynomials. "smooth" are the points on walls and boxes, where light has few edges;
"edges" are the others: floors with shadows, ceilings behind lamps, lamps.

python benchmarks/bases.py [--scenes cornell-box room] [--patches 1200 5000] [--points 1500] [--meshes even follows] [--gather]
    [--lines 8000]
"""

import argparse
import warnings
from dataclasses import replace

import numpy as np
from meshes import EACH, LEAST, READ, Places, patch_at, solved, used

import radiosity as rd
from radiosity.patches.polynomials import Polynomials

LINES = 8000  # of a patch of constants
SMOOTH = ("wall", "box", "block")  # words in names of surfaces
METHOD = {"method": "stochastic-jacobi-control-variate", "estimator": "bidirectional"}
GATHER = {"method": "gather"}
ROW = "  {:>8} {:>10} {:>8} {:>16} {:>16} {:>16} {:>6}"


def values(solution: rd.Solution, at: np.ndarray, places: Places) -> tuple[np.ndarray, np.ndarray]:
    """Return irradiance at points of patches, and the square of its error by sampling, (count, n_bands) each."""
    patches, error = solution.patches, solution.irradiance_standard_error[at] ** 2
    if solution.basis.size == 1:
        return solution.irradiance[at], error
    light = Polynomials(patches, solution.basis, solution.irradiance, solution.irradiance_coefficients)
    origin, first, second = (edge[patches.face[at]] for edge in patches.scene.frames)
    edges = np.stack([first, second], axis=2)
    u, v = np.einsum("mij,mj->mi", np.linalg.pinv(edges), places.points - origin).T
    a, b = light.place(at, u, v)
    functions = solution.basis.at(a, b, patches.scene.is_quad[patches.face[at]])[:, 1:]
    error = error + np.einsum("mnk,mk->mn", solution.irradiance_coefficients_standard_error[at] ** 2, functions**2)
    return np.maximum(light.at_places(at, a, b), 0), error


def errors(solution: rd.Solution, places: Places, truth: rd.Measurement, groups: list[np.ndarray]) -> list[tuple[float, float]]:
    """Return the RMS error and its part by sampling, relative, of each group of points."""
    at = patch_at(solution.patches, places.points, places.normals)
    known = (at >= 0) & np.isfinite(truth.standard_error).all(axis=1)
    rho, light = solution.patches.reflectance[at], truth.illuminance
    found, noise = values(solution, np.maximum(at, 0), places)
    square = (rho**2 * ((found - light) ** 2 - truth.standard_error**2)).sum(axis=1)
    sampling, there = (rho**2 * noise).sum(axis=1), ((rho * light) ** 2).sum(axis=1)
    rows = []
    for group in groups:
        weights = places.weights * (group & known)
        rows.append(tuple(float(np.sqrt(max(weights @ one, 0.0) / (weights @ there))) for one in (square, sampling)))
    return rows


def compare(name: str, counts: list[int], points: int, meshes: list[str], method: dict, lines: int) -> None:
    """Print the rows of a scene."""
    scene = rd.load_scene(name, allow_outside=True)
    scene = replace(scene, back=np.where(scene.back == rd.Back.PASSES, rd.Back.ABSORBS, scene.back).astype(np.uint8))
    read = solved(rd.adapt(scene, len(rd.subdivide(scene, cells=1)) + READ, seed=7))
    places = Places.of(read, points, np.random.default_rng(1))
    truth = rd.measure(read, rd.Sensors.of(places.points, places.normals), rays=EACH * points, seed=2)
    at = patch_at(read.patches, places.points, places.normals)
    smooth = np.array([any(word in name for word in SMOOTH) for name in scene.names])[read.patches.surface[at]]
    groups = [smooth | True, smooth, ~smooth]
    print(f"{name}: {scene.n_faces} faces; each error: total (sampling)", flush=True)
    print(ROW.format("mesh", "basis", "patches", "all", "smooth", "edges", "CPU s"), flush=True)
    for count in counts:
        few, many = rd.subdivide(scene, about=count), rd.subdivide(scene, about=4 * count)
        for mesh in meshes:
            for basis, patches in (("constant", many), ("linear", few), ("quadratic", few)):
                patches = patches if mesh == "even" else rd.adapt(scene, len(patches), basis=basis)
                begun = used()
                rays = max(lines * 4 * count, LEAST)
                solution = rd.solve(patches, **method, basis=basis, rays=rays, seed=1)
                seconds = used() - begun
                shown = [f"{total:.2%} ({own:.2%})" for total, own in errors(solution, places, truth, groups)]
                print(ROW.format(mesh, basis, len(patches), *shown, f"{seconds:.1f}"), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="+", default=["cornell-box", "room"])
    parser.add_argument("--patches", nargs="+", type=int, default=[1200, 5000])
    parser.add_argument("--points", type=int, default=1500)
    parser.add_argument("--meshes", nargs="+", default=["even", "follows"], choices=["even", "follows"])
    parser.add_argument("--lines", type=int, default=LINES, help="of a patch of constants; polynomials have as many in all")
    parser.add_argument("--gather", action="store_true", help="solve by gathers, not by iterations")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for scene_name in given.scenes:
        compare(scene_name, given.patches, given.points, given.meshes, GATHER if given.gather else METHOD, given.lines)
