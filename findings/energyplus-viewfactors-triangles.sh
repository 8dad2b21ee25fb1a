#!/usr/bin/env bash
# energyplus-viewfactors 1.0.0 writes View3D's .vs3 from EnergyPlus's epJSON. Its table has a heading of ten columns: number, four
# vertices, base, cmb, emit, name. A surface of three corners gets nine: no 0 stands for the fourth vertex. By the heading its
# emissivity is then its name. A wall of five corners, such as a gable, ends with KeyError. Rectangles are right.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'energyplus-viewfactors==1.0.0' 'click==8.3.1' 'pathvalidate==3.3.1'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
from importlib.metadata import version
from pathlib import Path

from energyplus_viewfactors.engine import ViewFactorEngine

AXES = ("vertex_x_coordinate", "vertex_y_coordinate", "vertex_z_coordinate")


def extract(name, **surfaces):
    """The .vs3 file of a zone, or the error; corners go counterclockwise from outside."""
    rules = {"vertex_entry_direction": "Counterclockwise", "coordinate_system": "World", "starting_vertex_position": "UpperLeftCorner"}
    walls = {
        called: {"zone_name": name, "surface_type": "Wall", "vertices": [dict(zip(AXES, corner)) for corner in corners]}
        for called, corners in surfaces.items()
    }
    data = {"GlobalGeometryRules": {"rules": rules}, "Zone": {name: {}}, "BuildingSurface:Detailed": walls}
    try:
        ViewFactorEngine(obj=data).extract(".")
    except Exception as error:
        return type(error).__name__
    return Path(f"{name}.vs3").read_text()


def columns(text):
    """The heading of surfaces without its mark, and each surface by it."""
    lines = [line.split() for line in text.splitlines()]
    (heading,) = [line[1:] for line in lines if line[:3] == ["!", "#", "v1"]]
    return heading, [dict(zip(heading, line[1:])) for line in lines if line[0] == "S"]


O, X, Y, Z = (0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)
heading, rows = columns(extract("tent", bottom=(O, Y, X), front=(O, X, Z), left=(O, Z, Y), slope=(X, Y, Z)))
print("energyplus-viewfactors", version("energyplus-viewfactors"))
print("heading:", *heading)
print("triangle by the heading:", rows[0])
_, (square,) = columns(extract("square", floor=(O, Y, (1, 1, 0), X)))
print("rectangle by the heading:", square)
gable = extract("gable", wall=(O, (4, 0, 0), (4, 0, 3), (2, 0, 4.5), (0, 0, 3)))
print("five corners:", gable)
assert square["v4"] == "4" and square["emit"] == "0.5" and square["name"] == "floor", "the behaviour has changed"
assert all("name" not in row for row in rows), "the behaviour has changed"
assert [row["emit"] for row in rows] == ["bottom", "front", "left", "slope"], "the behaviour has changed"
assert gable == "KeyError", "the behaviour has changed"
PYTHON
echo 'as stated: rows of triangles lack a column'
