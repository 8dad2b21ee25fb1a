"""RMS errors of pictures for CPU seconds, with and without a final gather, and of Mitsuba's path tracer: ``make bench-pictures``.

Scenes are built in, or files. Backs that let lines pass absorb, here and there: Mitsuba has no such thing. A scene without a
camera gets a fitted one. The error is the RMS of (picture - truth) in linear radiance over all pixels that see no lamp, nor lie
beside one, relative to the mean of the truth. The truth is two path traced pictures of other seeds, a and b; the mean of
(picture - a)(picture - b) holds none of their own noise. CPU seconds of ours hold the solution.

python benchmarks/pictures.py [--width 256] [--truth 256] [--scenes cornell-box room] [--contacts room] [--lines 256 1024]
"""

import argparse
import os
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

import radiosity as rd
from radiosity.device.backend import choose, entered, upload
from radiosity.image import render
from radiosity.image.lookup import Lookup
from radiosity.image.picture import choose_camera, first_hits, take
from radiosity.image.quantity import choose as quantity

sys.path.insert(0, str(Path(__file__).parents[1]))
from validation.path_tracer import WIDE, world_of

SAMPLES = 64  # a pixel, of the path tracer
AT_ONCE = 256
OURS = ((None, False), (64, False), (64, True), (256, False), (256, True), (512, False), (1024, False))  # lines a pixel, denoised
LINES = 1_000_000  # of the solution
ROW = "  {:<46} {:>8} {:>9}"


def used() -> float:
    """CPU seconds of this process so far."""
    times = os.times()
    return times.user + times.system


def traced(scene: rd.Scene, camera: rd.Camera, samples: int, seed: int) -> tuple[np.ndarray, float]:
    """Return a path traced picture, in exitance, and its CPU seconds without those of the scene."""
    low, high = scene.bounds
    centre, factor = (low + high) / 2, WIDE / (high - low).max()  # see `validation.path_tracer._wide`
    wide, device = replace(scene, vertices=(scene.vertices - centre) * factor), choose("cpu")
    origin, target = ((np.subtract(place, centre) * factor).tolist() for place in (camera.origin, camera.target))
    with entered(device) as mi:
        world = world_of(mi, wide, upload, device.types, merged=True)
        place = mi.ScalarTransform4f().look_at(origin, target, list(camera.up))
        film = {"type": "hdrfilm", "width": camera.width, "height": camera.height, "rfilter": {"type": "box"}}
        clip = {"near_clip": 1e-5 * WIDE, "far_clip": 100 * WIDE}
        view = {"type": "perspective", "fov": camera.fov, "fov_axis": "y", "to_world": place, "film": film, **clip}
        sensor, integrator = mi.load_dict(view), mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 16})
        begun, total = used(), np.zeros((camera.height, camera.width, scene.n_bands))
        for done in range(0, samples, AT_ONCE):
            step = min(samples - done, AT_ONCE)
            picture = mi.render(world, sensor=sensor, integrator=integrator, spp=step, seed=seed + done)
            total = total + step * np.array(picture, np.float64)[..., : scene.n_bands]
        return np.pi * total / samples, used() - begun


def without_lamps(scene: rd.Scene, camera: rd.Camera) -> np.ndarray:
    """Return the pixels that neither see a lamp nor lie beside one, (height, width) bool."""
    patches = rd.subdivide(scene, cells=1)
    rough = rd.solve(patches, method="random-walk", rays=20_000)
    shown = quantity(rough)
    lamps = np.pad(take(rough, shown, camera, look=Lookup(patches, shown.values, smooth=False), samples=64).own_light, 1)
    beside = [lamps[i : i + camera.height, j : j + camera.width] for i in range(3) for j in range(3)]
    return ~np.any(beside, axis=0)


def compare(name: str, width: int, truth: int, contacts: bool, gathers: list[int] | None) -> None:
    """Print the rows of a scene."""
    scene = rd.load_scene(name, allow_outside=True)
    scene = replace(scene, back=np.where(scene.back == rd.Back.PASSES, rd.Back.ABSORBS, scene.back).astype(np.uint8))
    rough = rd.solve(scene, "random-walk", rays=200_000)
    view = choose_camera(rough, None, None if scene.cameras else width, None, first_hits)
    camera = replace(view, width=width, height=round(width * view.height / view.width))
    traced(scene, camera, 1, 0)  # kernels are compiled
    one, other = (traced(scene, camera, truth, seed)[0] for seed in (10_000, 20_000_000))
    mask = without_lamps(scene, camera)
    level = float(((one + other) / 2)[mask].mean())

    def error(picture: np.ndarray) -> str:
        return f"{np.sqrt(max(((picture - one) * (picture - other))[mask].mean(), 0)) / level:.2%}"

    picture, seconds = traced(scene, camera, SAMPLES, 5)
    print(f"{name}, {camera.width} x {camera.height} pixels, truth of 2 x {truth} samples", flush=True)
    print(ROW.format("", "CPU s", "RMS error"))
    print(ROW.format(f"path tracer, {SAMPLES} samples a pixel", f"{seconds:.2f}", error(picture.astype(float))), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for lines, filtered in (row for row in OURS if gathers is None or row[0] in gathers):
            for _ in range(2):  # the first compiles kernels
                begun = used()
                solution = rd.solve(rd.subdivide(scene, contacts=contacts), rays=LINES)
                picture = render(solution, Path(folder) / "a.exr", camera=camera, final_gather=lines, denoise=filtered)
                seconds = used() - begun
            words = "patches alone" if lines is None else f"final gather, {lines} lines a pixel{', denoised' * filtered}"
            print(ROW.format(words, f"{seconds:.2f}", error(picture)), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--width", type=int, default=256)
    parser.add_argument("--truth", type=int, default=256)
    parser.add_argument("--scenes", nargs="+", default=["cornell-box", "room"])
    parser.add_argument("--contacts", nargs="*", default=[], help="scenes that are cut along contact lines, at our cost")
    parser.add_argument("--lines", nargs="*", type=int, help="final gathers of so many lines a pixel alone")
    given = parser.parse_args()
    for scene_name in given.scenes:
        compare(scene_name, given.width, given.truth, scene_name in given.contacts, given.lines)
