#!/usr/bin/env bash
# trimesh 5.2.0 counts the negative corners of an OBJ face back from the last vertex of the file. The format counts them back from
# the last vertex above the face, so that each part of a file can stand for itself. Of two squares that are written one after
# the other, each with "f -4 -3 -2 -1", both come out as the second. Nothing is said.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'trimesh==5.2.0' 'numpy==2.3.5'
"$folder/venv/bin/python" - <<'PYTHON'
import io

import trimesh


def load(second):
    small = ["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0", "f -4 -3 -2 -1"]
    large = ["v 0 0 5", "v 3 0 5", "v 3 3 5", "v 0 3 5", second]
    return trimesh.load(io.BytesIO("\n".join([*small, *large, ""]).encode()), file_type="obj", process=False, force="mesh")


relative = load("f -4 -3 -2 -1")
low, high = relative.triangles[:, :, 2].min(), relative.triangles[:, :, 2].max()
print(f"trimesh: area {relative.area:g} m2, right is 10; heights from {low:g} to {high:g} m, right is 0 to 5")
assert abs(relative.area - 18) < 1e-9 and low == high == 5, "the behaviour has changed"
PYTHON
echo 'as stated: relative corners are counted from the end of the file'
