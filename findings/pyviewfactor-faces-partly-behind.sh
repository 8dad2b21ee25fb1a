#!/usr/bin/env bash
# pyviewfactor 1.1.0: a wall at the edge of a floor that reaches below it. The part above has the view factor 0.2000 from the floor.
# The matrix has 0.1226, 0.0539 and 0.0158 where the wall reaches 0.2, 0.5 and 0.8 m below: the hidden part counts negatively. No
# warning is given. With strict_visibility the factor is 0.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'pyviewfactor==1.1.0' 'pyvista==0.49.1' 'numpy==2.3.5'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import warnings

import pyviewfactor
import pyvista

warnings.simplefilter("error")
FLOOR = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


def factor(below, **options):
    """From the floor to the wall x = 0, up to z = 1; F[i, j] goes from face j to face i."""
    wall = [[0.0, 1, -below], [0, 1, 1], [0, 0, 1], [0, 0, -below]]
    mesh = pyvista.PolyData(FLOOR + wall, [4, 0, 1, 2, 3, 4, 4, 5, 6, 7])
    return pyviewfactor.compute_viewfactor_matrix(mesh, **options)[1, 0]


found = [factor(below) for below in (0, 0.2, 0.5, 0.8)]
print("wall from 0, -0.2, -0.5, -0.8 m up:", [round(float(value), 4) for value in found], "right is 0.2000 for all")
assert abs(found[0] - 0.20004) < 1e-4
assert abs(found[1] - 0.1226) < 1e-3 and abs(found[2] - 0.0539) < 1e-3 and abs(found[3] - 0.0158) < 1e-3, "the behaviour has changed"
assert factor(0.5, strict_visibility=True) == 0, "the behaviour has changed"
PYTHON
echo 'as stated: what lies behind a face is taken off what lies in front of it'
