"""Radiance as the second reader of MGF: mgf2rad converts a file, and rtrace finds what rays meet in it."""

import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from mitsuba_rays import our_hits, random_rays

from radiosity.scene.formats.mgf.filter import program

from .compare import Difference
from .record import Reading, Refused, Surface

EFFICACY = 179.0  # lm/W, by which mgf2rad divides (WHTEFFICACY of its source)
RAYS = 200


def read(path) -> Reading:
    """Surfaces of mgf2rad's output. It keeps no sides, and no reflectance of lamps."""
    parts: dict[str, list] = {}
    colors: dict[str, tuple] = {}
    for modifier, kind, name, numbers in _primitives(_converted(path)):
        if modifier == "void":
            colors[name] = _color(kind, numbers)
        else:
            parts.setdefault(f"{_thing(name)}/{modifier}", []).append((*_measure(kind, numbers), *colors[modifier], modifier))
    return {key: _joined(rows) for key, rows in parts.items()}


def rays(path, ours, features: set[str]) -> list[Difference]:
    """Distances at which rays meet the scene; curved primitives are flat faces to us, so their rays differ."""
    if "curved primitives" in features:
        return []
    origins, directions = random_rays(ours.bounds, RAYS, 5)
    with tempfile.TemporaryDirectory() as folder:
        rad, octree = Path(folder) / "scene.rad", Path(folder) / "scene.oct"
        rad.write_text(_converted(path))
        octree.write_bytes(_run("oconv", str(rad)))
        given = np.column_stack([origins, directions]).tobytes()
        output = _run("rtrace", "-h", "-fdf", "-ab", "0", "-oL", "-lw", "0", str(octree), given=given)
    theirs = np.frombuffer(output, np.float32).astype(float)
    mine = our_hits(ours, origins, directions)[0]
    alike = np.isclose(theirs, mine, rtol=1e-4) | (np.isinf(mine) & ((theirs <= 0) | (theirs > 1e9)))
    return [] if alike.all() else [Difference("*", "distances of rays", mine[~alike], theirs[~alike])]


def _converted(path) -> str:
    done = subprocess.run([program("mgf2rad"), path.name], capture_output=True, text=True, cwd=path.parent, check=False)
    if done.returncode or "polygon" not in done.stdout:
        raise Refused(f"mgf2rad: {done.stderr.strip() or 'no polygon'}")
    return done.stdout


def _run(name: str, *arguments: str, given: bytes = b"") -> bytes:
    home = Path(program(name)).parent.parent
    done = subprocess.run(
        [program(name), *arguments], input=given, capture_output=True, env={"RAYPATH": str(home / "lib")}, check=False
    )
    if done.returncode:
        raise RuntimeError(f"{name} failed: {done.stderr.decode(errors='replace')[:300]}")
    return done.stdout


def _primitives(text: str):
    """(modifier, type, name, numbers) of a Radiance description."""
    words = [word for line in text.splitlines() if not line.startswith("#") for word in line.split()]
    at = 0
    while at < len(words):
        modifier, kind, name = words[at : at + 3]
        at += 3
        for _ in range(2):  # text and whole numbers
            at += 1 + int(words[at])
        count = int(words[at])
        yield modifier, kind, name, np.array(words[at + 1 : at + 1 + count], float)
        at += 1 + count


def _thing(name: str) -> str:
    """The object of a primitive: its name without the number of the primitive, and of arrays."""
    return ".".join(word for word in name.split(".")[:-1] if not re.fullmatch(r"a?\d+", word))


def _color(kind: str, numbers: np.ndarray) -> tuple:
    """Diffuse reflectance and exitance in lm/m²; None: not known."""
    if kind in ("light", "glow"):
        return None, np.pi * EFFICACY * numbers[:3]
    return (numbers[:3] * (1 - numbers[3]) if kind in ("plastic", "metal") else None), np.zeros(3)


def _measure(kind: str, numbers: np.ndarray) -> tuple:
    """Area, vector area, volume and points of a primitive."""
    if kind == "polygon":
        points = numbers.reshape(-1, 3)
        spokes = points[1:] - points[0]
        vector = np.cross(spokes[:-1], spokes[1:]).sum(axis=0) / 2
        return np.linalg.norm(vector), vector, vector @ points[0] / 3, points
    if kind in ("sphere", "bubble"):
        return 4 * np.pi * numbers[3] ** 2, None, None, numbers[:3] + np.array([[-1], [1]]) * numbers[3]
    if kind == "ring":
        return np.pi * abs(numbers[7] ** 2 - numbers[6] ** 2), None, None, numbers[None, :3]
    ends = numbers[:6].reshape(2, 3)
    first, last = numbers[6], numbers[-1]
    slant = np.hypot(np.linalg.norm(ends[1] - ends[0]), last - first)
    return np.pi * (first + last) * slant, None, None, ends


def _joined(rows: list) -> Surface:
    areas, vectors, volumes, points, reflectances, exitances, materials = zip(*rows, strict=True)
    flat = all(vector is not None for vector in vectors)
    corners = np.concatenate(points)
    sides = 1 if materials[0] == "single" else 2  # write_mgf's name; to mgf2rad all sides are alike
    known = all(value is not None for value in reflectances)
    return Surface(
        area=float(np.sum(areas)),
        bounds=np.stack([corners.min(axis=0), corners.max(axis=0)]),
        vector=np.sum(vectors, axis=0) if flat else None,
        volume=float(np.sum(volumes)) if flat else None,
        reflectance=np.average(reflectances, axis=0, weights=areas) if known else None,
        power=sides * np.sum([a * e for a, e in zip(areas, exitances, strict=True)], axis=0),
    )
