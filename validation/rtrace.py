"""Referee: Radiance's rtrace (G. J. Ward, "The RADIANCE lighting simulation and rendering system", SIGGRAPH 1994).

It is made to trace single paths, with no cache, no interpolation and no cut: one ambient division at each bounce (-ad 1) and no
cache (-aa 0), lamps sampled at a random point each (-ds 0 -dj 1), every one of them tested (-dt 0), and roulette (-lr 0)
in place of a limit. Irradiance (-I) at random points of a patch then averages to the patch's. Its random numbers differ from run
to run.
"""

import os
import subprocess
import tempfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np

import radiosity as rd

from .equations import both
from .points import on_patches
from .radiance_file import text
from .runs import SEEDS
from .scenes import radiance_scenes

OPTIONS = (
    "-h -I+ -u+ -fdf -ab 1000 -aa 0 -ad 1 -as 0 -av 0 0 0 -lr 0 -lw 0.05 -dj 1 -ds 0 -dt 0 -dc 1 -dr 0 -dp 0 -dv+ -ss 0 -st 1"
)
OFFSET = 1e-6  # of the scene's extent, in front of the patch
SECONDS = 600
FEWEST = {"veiled court": 2048}  # paths of a patch: few of them meet the bright sheet, and means of fewer are far from normal


def irradiance(patches: rd.Patches, paths: int, batches: int = SEEDS, seed: int = 77) -> np.ndarray:
    """(batches, n_patches, n_bands) independent estimates from ``paths`` points on each patch.

    Raises:
        ModuleNotFoundError: pyradiance is not installed.
    """
    generator = np.random.Generator(np.random.Philox(seed))
    lift = OFFSET * float(np.ptp(patches.scene.bounds, axis=0).max()) * patches.normal[:, None]
    points = np.concatenate([on_patches(patches, paths, generator) + lift for _ in range(batches)])
    normals = np.broadcast_to(np.tile(patches.normal[:, None], (batches, 1, 1)), points.shape)
    rays = np.concatenate([points, normals], axis=2).reshape(-1, 6)
    found = traced(text(patches.scene), rays).reshape(batches, len(patches), paths, 3).mean(axis=2, dtype=float)
    return found[:, :, : patches.scene.n_bands]


def program(name: str, *arguments: str, given: bytes = b"") -> bytes:
    """The output of one of Radiance's programs.

    Raises:
        ModuleNotFoundError: pyradiance is not installed.
        RuntimeError: the program fails.
    """
    spec = find_spec("pyradiance")
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError("No module named 'pyradiance'", name="pyradiance")
    home = Path(spec.origin).parent
    path = os.pathsep.join([str(home / "bin"), os.environ.get("PATH", "")])  # some of the programs start others
    environment = {**os.environ, "RAYPATH": str(home / "lib"), "PATH": path}
    command = [str(home / "bin" / name), *arguments]
    done = subprocess.run(command, input=given, capture_output=True, env=environment, timeout=SECONDS, check=False)
    if done.returncode:
        raise RuntimeError(f"{name} failed: {done.stderr.decode(errors='replace')[:300]}")
    return done.stdout


def traced(scene: str, rays: np.ndarray) -> np.ndarray:
    """(m, 3) irradiance of rays (m, 6), point and direction, in a scene, the text of a .rad file."""
    with tempfile.TemporaryDirectory() as folder:
        (rad, octree) = (Path(folder) / name for name in ("scene.rad", "scene.oct"))
        rad.write_text(scene)
        octree.write_bytes(program("oconv", str(rad)))
        output = program("rtrace", *OPTIONS.split(), str(octree), given=np.ascontiguousarray(rays, float).tobytes())
    return np.frombuffer(output, np.float32).reshape(-1, 3)


def run(quick: bool):
    """Patchwise comparisons of each scene."""
    rays, paths = (100_000, 16) if quick else (1_000_000, 256)
    for name, patches in radiance_scenes():
        theirs = irradiance(patches, max(paths, FEWEST.get(name, 0)))
        yield from both(name, patches, rays * SEEDS, theirs)
