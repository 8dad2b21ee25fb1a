"""ifcopenshell in a process of its own: what it makes of an IFC file, and errors where it fails."""

import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from ....errors import SceneError, installing

PROGRAM = Path(__file__).with_name("convert.py")
SECONDS = 1800


@dataclass(frozen=True, eq=False)
class Product:
    """A product's shape.

    Attributes:
        kind: its IFC class.
        name: its name, or its GlobalId.
        materials: names of its IFC materials.
        styles: name, color, transparency, side and factor of each style, each None where it is not given.
        vertices: (n, 3) m.
        triangles: (m, 3).
        style: (m,) number of each triangle's style; -1 where it has none.
        type: what its IFC object says that it is, or None.
        listed: triangles that the file lists for it; 0 where it is made of something else.
    """

    kind: str
    name: str
    materials: tuple[str, ...]
    styles: tuple[dict, ...]
    vertices: np.ndarray
    triangles: np.ndarray
    style: np.ndarray
    type: str | None = None
    listed: int = 0


def products(path: Path) -> tuple[list[Product], dict]:
    """The products of an IFC file, and what else is told of it.

    Raises:
        SceneError: ifcopenshell is not installed, or cannot read the file.
    """
    if find_spec("ifcopenshell") is None:
        raise SceneError(f"{path}: reading .ifc files needs 'ifcopenshell'; {installing('ifc')}")
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "shapes.npz"
        command = [sys.executable, str(PROGRAM), str(path.resolve()), str(target)]
        try:
            done = subprocess.run(command, capture_output=True, timeout=SECONDS, check=False, cwd=folder)
        except subprocess.TimeoutExpired:
            raise SceneError(f"{path}: ifcopenshell did not finish in {SECONDS} s; split the model") from None
        if done.returncode or not target.exists():
            raise SceneError(f"{path}: ifcopenshell cannot read it: {_reason(done)}")
        with np.load(target) as found:
            told = json.loads(found["told"].tobytes())
            shapes = [tuple(found[f"{key}{i}"] for key in "vtm") for i in range(len(told["products"]))]
    return [_product(*one) for one in zip(told["products"], shapes, strict=True)], told


def _product(one: dict, shape: tuple) -> Product:
    materials, styles = tuple(one["materials"]), tuple(one["styles"])
    return Product(one["class"], one["name"], materials, styles, *shape, type=one["type"], listed=one["listed"])


def _reason(done: subprocess.CompletedProcess) -> str:
    if done.returncode < 0:
        return f"it was ended by signal {-done.returncode}; is the file damaged?"
    lines = done.stderr.decode(errors="replace").strip().splitlines()
    return lines[-1][:200] if lines else f"status {done.returncode}"
