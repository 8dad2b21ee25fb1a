#!/usr/bin/env bash
# trimesh 5.2.0 and glTF 2.0. The values of a sparse accessor are left out: a square of 4 m2, whose buffer holds one of 1 m2 and whose
# sparse part moves three corners, comes as 1 m2. A primitive of the mode TRIANGLE_FAN (6) beside another one is left out as a whole.
# No error, and no warning or log message.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'trimesh==5.2.0' 'numpy==2.3.5'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import base64
import json
import logging
import warnings
from pathlib import Path

import numpy as np
import trimesh

warnings.simplefilter("error")
said = []
logging.getLogger("trimesh").addHandler(type("Kept", (logging.Handler,), {"emit": lambda self, record: said.append(record)})(logging.WARNING))
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)


def area(arrays, accessors, primitives):
    """The area that trimesh finds in a file of these arrays (a view each), accessors and primitives."""
    data, views = b"", []
    for array in arrays:
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        data += array.tobytes() + bytes(-array.nbytes % 4)
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    parts = {"buffers": [{"uri": uri, "byteLength": len(data)}], "bufferViews": views, "accessors": accessors}
    scene = {"scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": primitives}]}
    Path("file.gltf").write_text(json.dumps({"asset": {"version": "2.0"}} | parts | scene))
    return float(trimesh.load_scene("file.gltf", process=False).area)


def points(view, low, high):
    return {"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3", "min": low, "max": high}


triangles, fan = np.array([0, 1, 2, 0, 2, 3], np.uint16), np.arange(4, dtype=np.uint16)
corners = {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}
whole = area([SQUARE, triangles], [points(0, [0, 0, 0], [1, 1, 0]), corners], [{"attributes": {"POSITION": 0}, "indices": 1}])
moved = {"count": 3, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 3}}
sparse = area(
    [SQUARE, triangles, np.array([1, 2, 3], np.uint16), 2 * SQUARE[1:]],
    [points(0, [0, 0, 0], [2, 2, 0]) | {"sparse": moved}, corners],
    [{"attributes": {"POSITION": 0}, "indices": 1}],
)
both = area(
    [SQUARE, triangles, SQUARE + np.float32([0, 0, 1]), fan],
    [
        points(0, [0, 0, 0], [1, 1, 0]),
        corners,
        points(2, [0, 0, 1], [1, 1, 1]),
        {"bufferView": 3, "componentType": 5123, "count": 4, "type": "SCALAR"},
    ],
    [{"attributes": {"POSITION": 0}, "indices": 1}, {"attributes": {"POSITION": 2}, "indices": 3, "mode": 6}],
)
print(f"a square: {whole} m2; with three corners moved by a sparse accessor: {sparse}, right is 4; with a fan above: {both}, right is 2")
print("messages:", len(said))
assert abs(whole - 1) < 1e-6
assert abs(sparse - 1) < 1e-6, "the behaviour has changed"
assert abs(both - 1) < 1e-6, "the behaviour has changed"
assert not said, "the behaviour has changed"
PYTHON
echo 'as stated: sparse values and fans are left out and nothing is said'
