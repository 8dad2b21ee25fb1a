#!/usr/bin/env bash
# trimesh 5.2.0 writes GLB, PLY and STL in single precision, whatever the coordinates are, and says nothing.
# At map coordinates (UTM, metres) the numbers are half a metre apart: a box of 0.4 x 0.3 x 0.25 m comes back with another
# shape and 1.5 times its area. OBJ is text and keeps both. glTF could keep the shape, too: a node's translation is JSON, in
# double precision.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'trimesh==5.2.0' 'numpy==2.3.5'
"$folder/venv/bin/python" - <<'PYTHON'
import io

import numpy as np
import trimesh

corners = np.array([(x, y, z) for z in (0, 0.25) for y in (0, 0.3) for x in (0, 0.4)])
faces = np.array([(0, 1, 3), (0, 3, 2), (4, 7, 5), (4, 6, 7), (0, 5, 1), (0, 4, 5)])
ratio = {}
for place, origin in (("at the origin", (0, 0, 0)), ("at UTM", (500_000, 5_400_000, 100))):
    mesh = trimesh.Trimesh(corners + origin, faces, process=False)
    for kind in ("glb", "ply", "stl", "obj"):
        data = mesh.export(file_type=kind)
        data = data.encode() if isinstance(data, str) else data
        back = trimesh.load(io.BytesIO(data), file_type=kind, process=False, force="mesh")
        ratio[place, kind] = back.area / mesh.area
        print(f"{place}, {kind}: area {back.area:.4f} m2, written {mesh.area:.4f} m2")
for kind in ("glb", "ply", "stl"):
    assert abs(ratio["at the origin", kind] - 1) < 1e-6, ratio
    assert abs(ratio["at UTM", kind] - 1.49) < 0.02, "the behaviour has changed"
assert abs(ratio["at UTM", "obj"] - 1) < 1e-6, "the behaviour has changed"
PYTHON
echo 'as stated: GLB, PLY and STL change the shape, OBJ does not'
