#!/usr/bin/env bash
# Mitsuba 3.9.1: a rotation about an axis that is not of unit length is no rotation. <rotate x="1" y="2" angle="30"/> shears and
# scales, without a word: the square of 4 m² has 8.69 m² afterwards. About the same axis at unit length it keeps its area.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'mitsuba==3.9.1' 'drjit==1.5.0' 'numpy==2.3.5'
"$folder/venv/bin/python" - <<'PYTHON'
import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")


def area(axis):
    x, y = axis
    turn = f'<transform name="to_world"><rotate x="{x}" y="{y}" angle="30"/></transform>'
    scene = mi.load_string(f'<scene version="3.0.0"><shape type="rectangle">{turn}</shape></scene>')
    return float(scene.shapes()[0].surface_area())


axis = np.array([1.0, 2.0])
as_given, unit = area(axis), area(axis / np.linalg.norm(axis))
print(f"area of a square of 4 m² turned by 30 degrees: about (1, 2, 0) {as_given:.4f}, about its unit vector {unit:.4f}")
assert abs(unit - 4) < 1e-4, "the behaviour has changed"
assert abs(as_given - 8.6884) < 1e-3, "the behaviour has changed"
PYTHON
echo 'as stated: an axis that is not of unit length shears and scales'
