"""Bytes a patch and replicate that a run takes at its peak, beyond scene, patches and tree: ``python benchmarks/memory.py``."""

import subprocess
import sys

PATCHES = 1_000_000
REPLICATES = 8
STAGES = 2  # of the ladder, and what is kept of the first while the second goes on
ROW = "{:<12} {:>6} {:>10} {:>11} {:>7} {:>9} {:>8}"

CHILD = """
import resource, sys, time
import radiosity as rd
from radiosity.run.budget import first_stage
from radiosity.device.backend import choose
from radiosity.tracing.geometry import Geometry

name, cells, replicates, stages = sys.argv[1], *map(int, sys.argv[2:])
rd.solve(rd.subdivide(rd.load_scene(name), cells=2), quanta=2**18, replicates=replicates)  # compiler and kernels
patches = rd.subdivide(rd.load_scene(name), cells=cells)
_ = patches.area, patches.emission, patches.reflectance
begun = time.perf_counter()
if stages:
    rd.solve(patches, quanta=first_stage(replicates, len(patches)) << stages - 1, replicates=replicates)
else:
    geometry = Geometry(patches, choose("cpu"))
    geometry.prepare()
seconds = time.perf_counter() - begun
most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
if not stages:  # what is there, less than the most that was there
    import drjit as dr
    dr.flush_malloc_cache()
    most = int(open("/proc/self/statm").read().split()[1]) * resource.getpagesize()
print(len(patches), most, seconds)
"""


def memory() -> None:
    """One row a scene and number of replicates; each figure is the peak of a fresh process."""
    print(ROW.format("scene", "bands", "patches", "replicates", "stages", "seconds", "bytes"))
    for name, bands, cells in (("room", 1, 236), ("cornell-box", 3, 213)):
        _, base, _ = peak(name, cells, REPLICATES, 0)
        for replicates, stages in ((1, 1), (1, STAGES), (REPLICATES, 1), (REPLICATES, STAGES)):
            patches, most, seconds = peak(name, cells, replicates, stages)
            each = (most - base) / patches / replicates
            print(ROW.format(name, bands, int(patches), replicates, stages, f"{seconds:.1f}", f"{each:.0f}"), flush=True)


def peak(name: str, cells: int, replicates: int, stages: int) -> tuple[float, ...]:
    """Patches, largest resident bytes and seconds of a process that solves, or prepares to (no stages)."""
    told = subprocess.run(
        [sys.executable, "-c", CHILD, name, *map(str, (cells, replicates, stages))], capture_output=True, text=True, check=True
    )
    return tuple(map(float, told.stdout.split()))


if __name__ == "__main__":
    memory()
