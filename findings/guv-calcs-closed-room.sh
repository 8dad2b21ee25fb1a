#!/usr/bin/env bash
# guv-calcs 0.10.0: a closed cube whose six faces reflect rho, with an isotropic lamp of 1 W in the middle. Whatever the shape, what
# falls on all faces together is 1 W / (1 - rho). guv-calcs gives 1.05 of that at 0.5, 1.21 at 0.8 and 1.66 at 0.9, with its default
# grid and threshold, and more with a smaller threshold: 2.4 at 0.9. Grid points receive 1.06 times what the other faces send, those
# near an edge 1.13 to 1.25 times, and each reflection adds to it: from 0.95 on the passes have no end. Nothing is said.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'guv-calcs==0.10.0' 'photompy==0.3.1' 'numpy==2.3.5'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import math
import warnings
from importlib.metadata import version
from pathlib import Path

from guv_calcs import Lamp, Room

warnings.simplefilter("error")
SIDE, GAMMA = 3.0, range(0, 181, 5)
text = ["IESNA:LM-63-2002", "[TEST] 1", "[TESTLAB] ours", "[ISSUEDATE] today", "[MANUFAC] ours", "TILT=NONE"]
text += [f"1 1000 1 {len(GAMMA)} 1 1 2 0 0 0", "1 1 1", " ".join(map(str, GAMMA)), "0"]
text += [" ".join([f"{1000 / (4 * math.pi):.6f}"] * len(GAMMA))]  # mW/sr in all directions: 1 W
Path("lamp.ies").write_text("\n".join(text) + "\n")


def incident(reflectance, threshold=None):
    """Watts on all faces, of the exact ones."""
    room, middle = Room(x=SIDE, y=SIDE, z=SIDE, units="meters"), SIDE / 2
    room.add_lamp(Lamp(filedata="lamp.ies").move(middle, middle, middle).aim(middle, middle, 0))
    for surface in room.surfaces.values():
        surface.set_reflectance(reflectance)
    if threshold is not None:
        room.ref_manager.threshold = threshold
    room.calculate(hard=True)
    microwatts_per_square_centimetre = sum(float(surface.plane.values.mean()) for surface in room.surfaces.values())
    return microwatts_per_square_centimetre / 100 * SIDE**2 * (1 - reflectance)


print("guv-calcs", version("guv-calcs"))
found = {rho: round(incident(rho), 2) for rho in (0.0, 0.5, 0.8, 0.9)}
longer = round(incident(0.9, 1e-4), 2)
print("power on the faces, of the exact one, by reflectance:", found, "at 0.9 with a threshold of 1e-4:", longer)
assert found == {0.0: 1.0, 0.5: 1.05, 0.8: 1.21, 0.9: 1.66}, "the behaviour has changed"
assert longer == 2.43, "the behaviour has changed"
PYTHON
echo 'as stated: reflections make power'
