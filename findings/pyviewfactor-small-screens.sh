#!/usr/bin/env bash
# pyviewfactor 1.1.0: two parallel squares with a screen between that hides one from the other. The view factor is 0 where they are 1 m
# large, and still at 1 cm. At 1 mm it is 0.1998, as if the screen were not there. The ray test compares a product of three lengths
# with 1e-6, so what is small in its unit lets all rays pass. No warning is given; the same scene in millimetres is right.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'pyviewfactor==1.1.0' 'pyvista==0.49.1' 'numpy==2.3.5'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import warnings

import numpy as np
import pyviewfactor
import pyvista

warnings.simplefilter("error")
SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def factor(size):
    ends = pyvista.PolyData(size * np.concatenate([SQUARE, SQUARE[::-1] + [0, 0, 1]]), [4, 0, 1, 2, 3, 4, 4, 5, 6, 7])
    screen = size * ((SQUARE - [0.1, 0.1, 0]) * [1.2, 1.2, 1] + [0, 0, 0.5])
    obstacle = pyvista.PolyData(screen, [3, 0, 1, 2, 3, 0, 2, 3])
    return pyviewfactor.compute_viewfactor_matrix(ends, obstacles=[obstacle])[0, 1]


found = {size: round(float(factor(size)), 4) for size in (1000.0, 1.0, 0.01, 0.001)}
print("view factor behind a screen, by the size of the squares:", found, "right is 0")
assert found[1000.0] == found[1.0] == found[0.01] == 0
assert abs(found[0.001] - 0.1998) < 1e-3, "the behaviour has changed"
PYTHON
echo 'as stated: a screen of a millimetre hides nothing'
