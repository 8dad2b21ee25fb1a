#!/usr/bin/env bash
# Mitsuba 3.9.1 cuts each OBJ face from its first corner. An L-shaped floor whose first corner is an outer one gets triangles that
# lie on each other: 4 m2 in place of 3. A face that goes on in the next line after a backslash loses the corners there: a square
# is a triangle. No error, and no warning.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'mitsuba==3.9.1' 'numpy==2.3.5'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
from math import cos, pi, sin
from pathlib import Path

import mitsuba as mi

mi.set_variant("scalar_rgb")
floor = [(2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)]  # 2 x 2 m without a corner of 1 x 1 m
square = [(0, 0), (1, 0), (1, 1), (0, 1)]


def area(points, face):
    lines = [f"v {x:.9f} {y:.9f} 0" for x, y in points]
    Path("shape.obj").write_text("\n".join([*lines, face]) + "\n")
    return float(mi.load_dict({"type": "obj", "filename": "shape.obj", "face_normals": True}).surface_area())


concave = area(floor, "f 1 2 3 4 5 6")
two_lines = area(square, "f 1 2 3 \\\n4")
print(f"an L-shaped floor: {concave:.4f} m2, right is 3; a square in two lines: {two_lines:.4f} m2, right is 1")
assert abs(area(square, "f 1 2 3 4") - 1) < 1e-6
assert abs(area([*floor[2:], *floor[:2]], "f 1 2 3 4 5 6") - 3) < 1e-6  # from the inner corner on
assert abs(concave - 4) < 1e-6, "the behaviour has changed"
assert abs(two_lines - 0.5) < 1e-6, "the behaviour has changed"
PYTHON
echo 'as stated: areas are wrong and nothing is said'
