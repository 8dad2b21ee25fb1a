"""Speed in ratios measured in one run: ``make bench``. Nothing here is a test; machines differ and are noisy."""

import os
import resource
import subprocess
import sys
import time
import warnings
from dataclasses import replace
from functools import partial

import numpy as np
from history import FILE, keep, note
from methods import methods
from rates import LINES, measure
from scenes import black, room, strangers
from spans import spans

import radiosity as rd

MANY = 200_000  # lines a patch: there coherent firing is to pay
ROW = "{:<34} {:>9} {:>9} {:>9} {:>9} {:>7}  {}"


def main() -> None:
    """Print every table."""
    import drjit as dr

    print(f"{os.cpu_count()} processors, {dr.thread_count()} threads, wavefronts of {LINES:,} lines; rates in M lines a second")
    print(ROW.format("incoherent", "faces", "patches", "ours", "bare", "ratio", "wanted"))
    warnings.simplefilter("ignore")
    for tiles, cells, wanted in ((2, 12, ">= 0.8"), (24, 1, ">= 0.9"), (188, 1, ">= 0.9")):
        row("room", rd.subdivide(room(tiles), cells=cells), wanted)
    loaded = {name: rd.load_scene(path) for name, path in strangers().items()}
    for name, scene in loaded.items():
        row(name, rd.subdivide(black(scene), cells=1), ">= 0.9")
    finer_patches()
    coherent()
    spans()
    for name, scene in loaded.items():
        whole_run(name, scene)
    whole_run("room, 2 million patches", rd.load_scene("room"), cells=354)
    methods()
    start_up()
    keep()
    print(f"the figures are in {FILE}; `make bench-compare` compares the last two runs")


def row(name: str, patches, wanted: str, **choices):
    """One line of the table."""
    rates = measure(patches, **choices)
    n, faces = len(patches), patches.scene.n_faces
    note(f"{name}, {faces} faces, {n} patches", rates.ours, "M/s")
    note(f"{name}, {faces} faces, {n} patches, over the bare caster", rates.ratio, "ratio")
    print(ROW.format(name, faces, n, f"{rates.ours:.1f}", f"{rates.bare:.1f}", f"{rates.ratio:.2f}", wanted), flush=True)
    return rates


def finer_patches() -> None:
    """10^4 and 10^6 patches on the same faces, in turn."""
    scene = room(24)
    cuts = [rd.subdivide(scene, cells=cells) for cells in (1, 10)]
    rates = [[row("room, finer patches", cut, "").ours for cut in cuts] for _ in range(2)]
    few, many = (max(column) for column in zip(*rates, strict=True))
    print(f"  10^6 against 10^4 patches on equal faces: {few / many:.2f} times the time (wanted: within 1.3)")


def coherent() -> None:
    """Packets of like directions, where patches fire many lines: some faces of a room emit all of them."""
    for tiles, faces in ((24, 40), (24, 20), (24, 4), (96, 40), (96, 4), (1, 17)):
        scene = room(tiles)
        some = np.zeros((scene.n_faces, 1))
        some[:: max(scene.n_faces // faces, 1)] = 1.0
        patches = rd.subdivide(replace(scene, emission=some), cells=1)
        wanted = "> 1.3" if MANY * faces <= LINES else ""
        row(f"coherent, {min(faces, scene.n_faces)} patches fire", patches, wanted, coherent="always")


def whole_run(name: str, scene, **cut) -> None:
    """10^7 lines of a real run, replicates and bands as they are by default."""
    patches = rd.subdivide(scene, **cut)
    for replicates in (1,) if cut else (1, 8):
        for again in ("", ", again"):
            told = []
            begun = time.perf_counter()
            listener = partial(remember, told)
            solution = rd.solve(patches, "random-walk", rays=10_000_000, replicates=replicates, progress=listener)
            first = next(t for t, p in told if p.message == "tracing") - begun
            last, whole = told[-1][0] - begun, time.perf_counter() - begun
            note(f"{name}, {len(patches)} patches, 10^7 lines, {replicates} replicate(s){again}", whole, "s")
            print(
                f"{name}, {len(patches):,} patches, {replicates} replicate(s){again}: {solution.rays:,} lines; end of the first "
                f"sweep after {first:.2f} s, of the last after {last:.2f} s, in all {whole:.2f} s",
                flush=True,
            )
    print(f"  peak memory so far {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20:.2f} GiB")


def remember(told: list, progress) -> None:
    """A listener."""
    told.append((time.perf_counter(), progress))


START = """
import time
begun = time.perf_counter()
import radiosity as rd

def told(progress):
    if progress.message == "tracing":
        print(f"start-up to the end of the first sweep {time.perf_counter() - begun:.2f} s")
        raise SystemExit

rd.solve(rd.load_scene("room"), rays=10**7, progress=told)
"""


def start_up() -> None:
    """A new process, to the end of its first sweep."""
    begun = time.perf_counter()
    print(subprocess.run([sys.executable, "-c", START], capture_output=True, text=True).stdout.strip(), end="; ")
    whole = time.perf_counter() - begun
    note("start-up, a whole process to the end of its first sweep", whole, "s")
    print(f"the whole process {whole:.2f} s")


if __name__ == "__main__":
    main()
