"""A process of ``make bench-error``: solves one scene by one method, as often as it is told to.

``python error_worker.py SCENE METHOD`` reads a JSON object a line from standard input and answers each with one. The package is
the one that PYTHONPATH names. METHOD is a name with choices, such as ``gather/reconstruction=smooth``, or ``photon-loop``.
"""

import gc
import hashlib
import json
import os
import sys
import time
import warnings
from pathlib import Path

import numpy as np
from error_formulas import means_squares, squares, surface_means
from error_scenes import SETTINGS

import radiosity as rd

LOOP = "photon-loop"
MUCH = 0.1  # of the variance
AGAIN = 1000  # from the seed of a long run to that of its second


class Worker:
    """The patches, and what solves them."""

    def __init__(self, scene: str, method: str):
        self.patches = SETTINGS[scene].make()
        self.name, self.choices = parsed(method)

    def describe(self) -> dict:
        """Size and digest of the patches, and the method's equation."""
        patches, found = self.patches, hashlib.sha256()
        for values in (patches.area, patches.reflectance, patches.emission, patches.centroid, patches.surface):
            found.update(np.ascontiguousarray(values).tobytes())
        size = {"patches": len(patches), "faces": patches.scene.n_faces, "bands": len(patches.scene.bands)}
        return {**size, "digest": found.hexdigest()[:12], "equation": self.equation()}

    def equation(self) -> str:
        """The equation that the method solves."""
        if self.name == LOOP:
            return "continuous"
        return getattr(rd.method.resolve(self.name, **self.choices), "equation", "discrete")

    def measure(self, rays: float, seed: int, reference: str | None = None) -> dict:
        """Solve once: seconds, lines, and squares of errors a band; without a reference only seconds and lines."""
        took, solution = self._timed(rays, seed)
        told = {**took, "rays": solution.rays, "stated": solution.error}
        if reference is None:
            return told
        with np.load(reference) as file:
            truth = file["irradiance"]
        reflectance, of_patches, surface = self.patches.reflectance, self.patches.area, self.patches.surface
        told["squares"] = squares(reflectance, of_patches, solution.irradiance, truth).tolist()
        area, its_means = surface_means(reflectance, of_patches, surface, truth)
        _, means = surface_means(reflectance, of_patches, surface, solution.irradiance)
        return {**told, "means_squares": means_squares(area, means, its_means).tolist()}

    def keep(self, rays: float, seed: int, file: str) -> dict:
        """Solve, and write what a reference is made of.

        Where few lines hit a patch, its stated error is a bound (of a whole line), and may be a hundred times too large. Where
        such patches make up much of the stated error, the scene is solved twice, and the difference tells the error.
        """
        patches = self.patches
        took, solution = self._timed(rays, seed, replicates=8)
        told, mean = {**took, "rays": solution.rays}, solution.irradiance
        variance = squares(patches.reflectance, patches.area, mean + solution.irradiance_standard_error, mean)
        power = self._reflected(solution)
        bounds = np.where(solution.few[:, None], solution.irradiance_standard_error, 0.0)
        if (squares(patches.reflectance, patches.area, mean + bounds, mean) > MUCH * variance).any():
            took, other = self._timed(rays, seed + AGAIN, replicates=8)
            told = {key: value + {**took, "rays": other.rays}[key] for key, value in told.items()}
            half, mean = (mean - other.irradiance) / 2, (mean + other.irradiance) / 2
            variance, power = squares(patches.reflectance, patches.area, mean + half, mean), [*power, *self._reflected(other)]
        area, means = surface_means(patches.reflectance, patches.area, patches.surface, mean)
        error = np.std(power, axis=0, ddof=1) / np.sqrt(len(power)) / area[:, None]
        part = Path(file).with_suffix(".part.npz")
        np.savez(
            part,
            irradiance=mean,
            variance=variance,
            means_variance=means_squares(area, means + error, means),
            reflectance=patches.reflectance,
            area=patches.area,
            surface=patches.surface,
            rays=told["rays"],
            cpu=told["cpu"],
        )
        part.replace(file)
        return {**told, "error": float(np.sqrt(variance.max()))}

    def _reflected(self, solution) -> list[np.ndarray]:
        """Power that each surface reflects in each replicate, (n_surfaces, n_bands) each, without surfaces of no area."""
        some = np.bincount(self.patches.surface, minlength=len(self.patches.scene.names)) > 0
        return list(solution.surface_power[1][:, some])

    def _timed(self, rays: float, seed: int, replicates: int | None = None):
        gc.collect()
        before, begun = os.times(), time.perf_counter()
        if self.name == LOOP:
            from error_photons import photons

            solution = photons(self.patches, int(rays), seed, replicates or 1)
        else:
            solution = rd.solve(
                self.patches, self.name, rays=rays, seed=seed, replicates=replicates, device="cpu", **self.choices
            )
        after, wall = os.times(), time.perf_counter() - begun
        cpu = after.user + after.system - before.user - before.system
        return {"cpu": cpu, "wall": wall}, solution


def parsed(method: str) -> tuple[str, dict]:
    """Name and choices of ``name/choice=value/choice=value``."""
    name, *rest = method.split("/")
    choices = {}
    for word in rest:
        key, _, value = word.partition("=")
        try:
            choices[key] = json.loads(value)
        except json.JSONDecodeError:
            choices[key] = value
    return name, choices


def main() -> None:
    """Answer until the input ends; what libraries print goes to standard error."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    warnings.simplefilter("ignore")
    worker = None
    for line in sys.stdin:
        try:
            worker = worker or Worker(*sys.argv[1:3])
            asked = json.loads(line)
            answer = getattr(worker, asked.pop("do"))(**asked)
        except (rd.RadiosityError, ImportError) as error:
            answer = {"refused": " ".join(str(error).split())}
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main()
