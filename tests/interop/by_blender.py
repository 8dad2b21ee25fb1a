"""Blender's importers as the second reader, in a process of their own (``bpy`` wants its own numpy)."""

import json
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from .record import Reading, Refused, surface

PYTHON = "RADIOSITY_BPY_PYTHON"  # a Python that has bpy, where this one has not
SECONDS = 1500


def python() -> str | None:
    """The Python that has bpy, if there is one."""
    return os.environ.get(PYTHON) or (sys.executable if find_spec("bpy") else None)


def read_all(paths: list[Path], folder: Path) -> dict[Path, dict]:
    """What Blender makes of each file: an error, or records by 'object|material'."""
    jobs, results = folder / "blender_jobs.json", folder / "blender_results.json"
    jobs.write_text(json.dumps([str(path) for path in paths]))
    script = Path(__file__).with_name("blender_script.py")
    environment = {key: text for key, text in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run(
        [str(python()), str(script), str(jobs), str(results)],
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
        env=environment,
    )
    if not results.exists():
        raise RuntimeError(f"Blender failed: {done.stdout[-500:]} {done.stderr[-1500:]}")
    return dict(zip(paths, json.loads(results.read_text()), strict=True))


def reading(records: dict, name, *, sides: bool = False, color: bool = True) -> Reading:
    """Records as surfaces.

    Args:
        name: makes our name of an object's and a material's.
        sides: backface culling of a material means one side.
        color: the file may give colours.
    """
    if "error" in records:
        raise Refused(records["error"])
    parts: dict[str, list[dict]] = {}
    for key, record in records.items():
        parts.setdefault(name(*key.split("|", 1)), []).append(record)
    result = {}
    for key, found in parts.items():
        triangles = np.concatenate([np.array(record["triangles"]) for record in found])
        count = [len(record["triangles"]) for record in found]
        shining = np.repeat([record["sides"] for record in found], count)[:, None] if sides else 2
        known = color and all(record["material"] for record in found)
        result[key] = surface(
            triangles,
            reflectance=np.concatenate([record["reflectance"] for record in found]) if known else None,
            exitance=np.pi * shining * np.concatenate([record["radiance"] for record in found]),
            sides=max(record["sides"] for record in found) if sides else None,
            sampled=True,
        )
    return result
