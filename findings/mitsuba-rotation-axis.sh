#!/usr/bin/env bash
# Mitsuba 3.9.1: a rotation about an axis that is not of unit length is no rotation. <rotate x="1" y="1" z="0" angle="90"/> shears
# and stretches, and the normals that a cube brings along are turned otherwise than its faces, so that its sides shade wrongly and
# light may come to a back. Nothing is said. The same axis of unit length turns both alike.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'mitsuba==3.9.1' 'drjit==1.5.0' 'numpy==2.3.5'
"$folder/venv/bin/python" - <<'PYTHON'
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")


def cube(axis):
    """Area, and the largest angle between a face and the normals that it brings along, degrees."""
    shape = mi.load_string(
        '<scene version="3.0.0"><shape type="cube"><transform name="to_world"><rotate x="{}" y="{}" z="{}" angle="90"/>'
        "</transform></shape></scene>".format(*axis)
    ).shapes()[0]
    points = np.array(shape.vertex_positions_buffer()).reshape(-1, 3)
    normals = np.array(shape.vertex_normals_buffer()).reshape(-1, 3)
    corners = np.array(shape.faces_buffer()).reshape(-1, 3)
    across = np.cross(points[corners[:, 1]] - points[corners[:, 0]], points[corners[:, 2]] - points[corners[:, 0]])
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    cosines = np.einsum("ij,ij->i", across, normals[corners[:, 0]])
    return float(shape.surface_area()), float(np.degrees(np.arccos(np.clip(cosines.min(), -1, 1))))


print("mitsuba", mi.__version__)
found = {}
for axis in ((1, 1, 0), (0.7071067811865476, 0.7071067811865476, 0)):
    found[axis] = cube(axis)
    print(f"axis {axis}: area {found[axis][0]:.3f} (a cube of edge 2 has 24), normals off by up to {found[axis][1]:.1f} degrees")
long, unit = found.values()
assert abs(unit[0] - 24) < 1e-3 and unit[1] < 0.1, "the behaviour has changed"
assert abs(long[0] - 24) > 1 and long[1] > 5, "the behaviour has changed"
PYTHON
echo 'as stated: the axis of a rotation must have unit length'
