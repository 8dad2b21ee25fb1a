"""Footprints of runs, each method in a process of its own: seconds, lines, and the memory of the process beyond the scene."""

import ctypes
import gc
import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..device.backend import give_back_memory
from ..errors import MethodError, RadiosityError, RadiosityWarning
from ..scene import load_scene
from ..scene.model import Scene
from .hall import hall


@dataclass(frozen=True, eq=False)
class Footprint:
    """The footprint of one run.

    Attributes:
        label: what was varied, such as "10M lines".
        seconds, lines: of the run alone.
        memory: bytes, peak of the process during the run less what it had before, with scene, patches and kernels.
        irradiance: (n_patches, n_bands).
    """

    label: str
    seconds: float
    lines: int
    memory: float
    irradiance: np.ndarray


def scene_of(name: str) -> Scene:
    """Return a scene of the study by its name."""
    return hall() if name == "hall" else load_scene(name)


def footprints(scene: str, about: int, method: str, runs: list[tuple[str, dict]], *, warm: bool) -> list[Footprint] | str:
    """Return the footprints of runs of one method, the cheapest first, or the reason why one was refused.

    Args:
        scene, about: the scene that is solved, and about how many patches it has (cut in powers of two).
        method: a preset's name.
        runs: label and options of ``radiosity.solve`` of each run.
        warm: kernels are compiled by runs on the same patches, not on fewer ones.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "runs.npz"
        task = json.dumps({"scene": scene, "about": about, "method": method, "runs": runs, "warm": warm, "path": str(path)})
        done = subprocess.run([sys.executable, "-m", "radiosity.lab.footprint", task], capture_output=True, text=True)
        if done.returncode == 2:
            return done.stdout.strip()
        if done.returncode != 0:
            raise MethodError(f"the run of {method} on {scene} in {about} patches ended: {done.stderr.strip()[-500:]}")
        with np.load(path, allow_pickle=False) as file:
            facts = json.loads(str(file["facts"]))
            return [
                Footprint(label, seconds, lines, memory, file[f"irradiance_{i}"])
                for i, (label, seconds, lines, memory) in enumerate(facts)
            ]


def _measure(task: dict) -> None:
    """Measure the runs of a task; called in a process of its own."""
    import warnings

    from ..patches import subdivide
    from ..run.solve import solve

    warnings.simplefilter("ignore", RadiosityWarning)
    scene = scene_of(task["scene"])
    first = task["runs"][0][1]
    patches = subdivide(scene, about=task["about"], powers_of_two=True)
    small = subdivide(scene, cells=1, powers_of_two=True)
    for _ in range(2):
        solve(patches if task["warm"] else small, task["method"], **first)  # compiles kernels
    _ = patches.corners, patches.emission, patches.reflectance
    facts, arrays = [], {}
    for at, (label, options) in enumerate(task["runs"]):
        before = resident()
        solution = solve(patches, task["method"], **options)
        facts.append((label, solution.seconds, solution.rays, max(peak() - before, 0.0)))
        arrays[f"irradiance_{at}"] = solution.irradiance
    np.savez(task["path"], facts=np.array(json.dumps(facts)), **arrays)


def resident() -> float:
    """Return the bytes that the process has now; its peak is counted from here on.

    What Dr.Jit and the C library keep for reuse is given back first: the next run would take it unseen.
    """
    gc.collect()
    give_back_memory()
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)  # of glibc
    if trim is not None:
        trim(0)
    with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
        file.write("5")
    return _status("VmRSS")


def peak() -> float:
    """Return the most bytes that the process had since `resident` was called."""
    return _status("VmHWM")


def _status(name: str) -> float:
    with open("/proc/self/status", encoding="ascii") as file:
        line = next(line for line in file if line.startswith(name))
    return 1024.0 * int(line.split()[1])


if __name__ == "__main__":
    try:
        _measure(json.loads(sys.argv[1]))
    except RadiosityError as error:
        print(error)
        sys.exit(2)
