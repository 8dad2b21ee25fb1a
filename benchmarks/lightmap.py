"""CPU seconds of lightmaps to 1 % of error, ours and those that Blender's Cycles bakes: ``make bench-lightmap``.

Both bake the irradiance of the same triangles at the same places on the same page: diffuse light, direct and indirect, without
colour. The error is the RMS of (value - truth), relative to the mean of the truth, over texels well inside of charts. Left out
are those beside which the truth falls below half: of a texel that a box or lamp covers in part, each program takes other points.
The truth is two bakes of Cycles with other seeds, a and b: the mean of (value - a)(value - b) holds none of their own noise.
Seconds of ours hold the solution; those of Blender are of the bake alone. Blender needs a Python that has bpy: give it with
--blender.

python benchmarks/lightmap.py [--blender python3.11] [--scene room] [--size 96] [--truth 1024]
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import radiosity as rd

OURS = (32, 64, 128, 256, 512, 1024)  # lines a texel
THEIRS = (64, 256, 1024)  # samples a texel
RAYS = 500_000  # of the solution
TARGET = 0.01
ROW = "  {:<32} {:>8} {:>8}"


def used() -> float:
    """CPU seconds of this process so far."""
    times = os.times()
    return times.user + times.system


def seconds_to(rows: list[tuple[float, float]]) -> float:
    """Return the seconds at which the error is `TARGET`, on the line through the logarithms of the two rows nearest to it."""
    seconds, errors = np.log(np.array(rows)).T
    order = np.argsort(np.abs(errors - np.log(TARGET)))[:2]
    (t, s), (e, d) = seconds[order], errors[order]
    return float(np.exp(t + (s - t) * (np.log(TARGET) - e) / (d - e)))


def main() -> None:
    """Print a table, and the ratio."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--blender", default=sys.executable)
    parser.add_argument("--scene", default="room")
    parser.add_argument("--size", type=int, default=96)
    parser.add_argument("--truth", type=int, default=1024)
    given = parser.parse_args()
    scene = rd.load_scene(given.scene)

    def ours(lines: int):
        begun = used()
        solution = rd.solve(scene, rays=RAYS)
        found = rd.bake_lightmap(solution, size=given.size, lines=lines, quantity="irradiance")
        return found, used() - begun

    page = ours(16)[0]  # kernels are compiled
    atlas, texels = page.atlas, page.texels
    inside = np.full(page.covered.shape, -1)
    inside[texels.row, texels.column] = np.where(texels.inside, atlas.chart[texels.triangle], -1)
    around = [np.roll(inside, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    back = np.zeros(inside.shape, bool)
    back[texels.row, texels.column] = atlas.triangles.back[texels.triangle]
    mask = np.all([one == inside for one in around], axis=0) & (inside >= 0) & ~page.own_light & ~back
    with tempfile.TemporaryDirectory() as folder:
        room, out = Path(folder) / "room.npz", Path(folder) / "out.npz"
        front = ~atlas.triangles.back
        face = atlas.triangles.face[front]
        np.savez(
            room,
            corners=atlas.vertices[atlas.corners[front]],
            uv=atlas.places[front] / [atlas.width, atlas.height],
            reflectance=scene.reflectance[face],
            emission=scene.emission[face],
            width=atlas.width,
            height=atlas.height,
        )

        def theirs(samples: int, seed: int):
            script = Path(__file__).with_name("lightmap_blender.py")
            words = [given.blender, str(script), str(room), str(out), str(samples), str(seed)]
            subprocess.run(words, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            found = np.load(out)
            return np.pi * found["values"][..., : scene.n_bands].astype(float), float(found["seconds"])

        one, other = (theirs(given.truth, seed)[0] for seed in (101, 102))
        truth = ((one + other) / 2).max(axis=2)
        beside = np.array([np.roll(truth, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)])
        mask &= beside.min(axis=0) > beside.max(axis=0) / 2
        level = float(((one + other) / 2)[mask].mean())

        def error(values: np.ndarray) -> float:
            return float(np.sqrt(max(((values - one) * (values - other))[mask].mean(), 0)) / level)

        print(f"{given.scene}, {atlas.width} x {atlas.height} texels, truth of 2 x {given.truth} samples of Cycles")
        print(ROW.format("", "CPU s", "RMS error"), flush=True)
        tables = {}
        for name, budget, bake in (("Cycles", THEIRS, lambda n: theirs(n, 5)), ("ours", OURS, ours)):
            tables[name] = []
            for count in budget:
                found, seconds = bake(count)
                found = found if isinstance(found, np.ndarray) else found.values
                tables[name].append((seconds, error(found)))
                print(ROW.format(f"{name}, {count} a texel", f"{seconds:.2f}", f"{tables[name][-1][1]:.2%}"), flush=True)
                if tables[name][-1][1] < TARGET / 1.5:
                    break
    seconds = {name: seconds_to(rows) for name, rows in tables.items()}
    ratio = seconds["Cycles"] / seconds["ours"]
    print(f"to {TARGET:.0%}: Cycles {seconds['Cycles']:.2f} s, ours {seconds['ours']:.2f} s: {ratio:.1f} times")


if __name__ == "__main__":
    main()
