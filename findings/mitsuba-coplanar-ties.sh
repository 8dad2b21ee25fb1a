#!/usr/bin/env bash
# Mitsuba 3.9.1 on the CPU (Embree): where two faces lie in one plane, a ray of `coherent=True` meets one or the other face
# depending on the rays that travel in its packet. The same rays in another order meet other faces; the distances are equal.
# With `coherent=False` the choice is the same in any order, though it is no rule that one could state.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'mitsuba==3.9.1' 'drjit==1.5.0' 'numpy==2.3.5' 'karellen-llvm-core==23.1.4'
library=$(find "$folder/venv" -name 'libLLVM.so.*' | head -1)
DRJIT_LIBLLVM_PATH="$library" "$folder/venv/bin/python" - <<'PYTHON'
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")
n, grid = 16, np.linspace(0, 1, 17)
place = lambda x, y: (x, y, 0.1 * x + 0.2 * y)  # one plane
corners, faces = [], []
for i in range(n):
    for j in range(n):
        k = len(corners)
        corners += [place(grid[i + a], grid[j + b]) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        faces += [(k, k + 1, k + 2), (k, k + 2, k + 3)]
small, k = len(faces), len(corners)
corners += [place(0, 0), place(1, 0), place(1, 1), place(0, 1)]
faces += [(k, k + 3, k + 1), (k + 1, k + 3, k + 2)]  # a large quadrilateral over all of them
mesh = mi.Mesh("faces", len(corners), len(faces))
parameters = mi.traverse(mesh)
parameters["vertex_positions"] = np.array(corners, np.float32).ravel()
parameters["faces"] = np.array(faces, np.uint32).ravel()
parameters.update()
scene = mi.load_dict({"type": "scene", "mesh": mesh})
random, count = np.random.default_rng(1), 1 << 18
origin = np.stack([random.random(count), random.random(count), 1 + random.random(count)]).astype(np.float32)
target = np.stack([random.random(count), random.random(count), np.zeros(count)])
way = (target - origin) / np.linalg.norm(target - origin, axis=0)
order, changed = random.permutation(count), {}
for coherent in (False, True):

    def faces_met(rays):
        ray = mi.Ray3f(mi.Point3f(origin[:, rays]), mi.Vector3f(way[:, rays].astype(np.float32)))
        return np.array(scene.ray_intersect_preliminary(ray, coherent=coherent).prim_index)

    first, other = faces_met(np.arange(count)), faces_met(order)
    changed[coherent] = int((first[order] != other).sum())
    print(f"coherent={coherent}: {changed[coherent]} of {count} rays meet another face when the order changes; "
          f"{(first >= small).mean():.0%} meet the large one")
assert changed[False] == 0, "the behaviour has changed"
assert changed[True] > 100, "the behaviour has changed"
PYTHON
echo 'as stated: with coherent=True the face met depends on the other rays'
