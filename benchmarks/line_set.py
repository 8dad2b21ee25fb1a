"""Time and memory of line sets of the room: tracing once, then solving in three bands of unlike colours.

python benchmarks/line_set.py [ABOUT_PATCHES LINES ...]

Each case has a process of its own. CPU seconds are the least of three solves; memory is the peak of the process.
"""

import os
import resource
import subprocess
import sys

import numpy as np

import radiosity as rd

CASES = (544, 10**6, 20_000, 10**6, 20_000, 10**7, 100_000, 10**7)
ROW = "{:>8} {:>11} {:>10} {:>9} {:>9} {:>9} {:>9}"


def used() -> float:
    """CPU seconds of this process so far."""
    times = os.times()
    return times.user + times.system


def least(what, times: int = 3) -> float:
    """The least CPU seconds of some calls."""
    found = []
    for _ in range(times):
        begun = used()
        what()
        found.append(used() - begun)
    return min(found)


def measure(about: int, rays: int) -> None:
    """One row."""
    patches = rd.subdivide(rd.load_scene("room"), about=about)
    begun = used()
    lines = rd.trace_lines(patches, rays=rays, sources={"light": "front"})
    traced = used() - begun
    colors = np.random.default_rng(0).uniform(0.2, 0.8, (len(patches.scene.names), 3))
    grey = least(lambda: lines.solve())
    color = least(lambda: lines.solve({"light": [30, 40, 50]}, colors))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    numbers = (f"{value:.2f}" for value in (traced, grey, color))
    print(ROW.format(len(patches), lines.rays, len(lines.pairs.keys), *numbers, f"{peak:.0f}"), flush=True)


if __name__ == "__main__":
    given = [int(float(text)) for text in sys.argv[1:]] or CASES
    if os.environ.get("ONE_CASE"):
        measure(*given)
    else:
        print(ROW.format("patches", "lines", "pairs", "trace s", "grey s", "RGB s", "MiB"), flush=True)
        for about, rays in zip(given[::2], given[1::2], strict=True):
            subprocess.run([sys.executable, __file__, str(about), str(rays)], env=os.environ | {"ONE_CASE": "1"}, check=True)
