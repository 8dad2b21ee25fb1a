"""Radiosity by tracing lines: B = E + rho F B, without ever forming F.

scene file -> Scene -> Patches -> [ numbers -> lines -> hits -> tally ] -> Solution -> files, pictures

scene = load_scene("room.mgf")               # or Scene.from_arrays(...)
patches = subdivide(scene, size=0.10)        # or cells=k, or leave it to solve
solution = solve(patches, rays=10_000_000)   # radiosity and its standard error, per patch and band
solution.export("room.glb")
"""

from . import llvm
from .engine.solve import solve
from .errors import DeviceError, MethodError, OutputError, RadiosityError, RadiosityWarning, SceneError
from .method import PRESETS, Method
from .patches import Patches, subdivide
from .scene import Back, Camera, Scene, load_scene
from .solution import Solution, load_solution

llvm.point()  # before anything imports Dr.Jit, which loads libLLVM at once

__all__ = [
    "PRESETS",
    "Back",
    "Camera",
    "DeviceError",
    "Method",
    "MethodError",
    "OutputError",
    "Patches",
    "RadiosityError",
    "RadiosityWarning",
    "Scene",
    "SceneError",
    "Solution",
    "load_scene",
    "load_solution",
    "solve",
    "subdivide",
]
