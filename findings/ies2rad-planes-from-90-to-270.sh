#!/usr/bin/env bash
# Radiance's ies2rad (pyradiance 1.3.1): an IES file whose planes go from 90 to 270 degrees (LM-63: the same on both sides of that
# plane) comes out with the planes of 90 and 270 changed for each other. The same luminaire with planes from 0 to 360 is right, so
# that two files of one luminaire give different light. Nothing is said.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'pyradiance==1.3.1' 'numpy==2.3.5'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import os
import subprocess
from pathlib import Path

import pyradiance

root = Path(pyradiance.__file__).parent
environment = os.environ | {"PATH": f"{root / 'bin'}{os.pathsep}{os.environ['PATH']}", "RAYPATH": f".{os.pathsep}{root / 'lib'}"}
intensity = {0: 200, 90: 300, 180: 200, 270: 100, 360: 200}  # cd, the same at all angles from 0 to 90 degrees


def received(planes):
    """Relative irradiance below the luminaire, on the side of 90 degrees (y > 0), and on that of 270."""
    rows = [f"{intensity[plane]} {intensity[plane]}" for plane in planes]
    numbers = [f"1 -1 1 2 {len(planes)} 1 2 0 0 0", "1 1 10", "0 90", " ".join(map(str, planes)), *rows]
    Path("lamp.ies").write_text("\n".join(["IESNA:LM-63-2002", "[TEST] none", "TILT=NONE", *numbers]) + "\n")
    subprocess.run(["ies2rad", "-t", "default", "lamp.ies"], env=environment, check=True, capture_output=True)
    Path("lamp.oct").write_bytes(subprocess.run(["oconv", "lamp.rad"], env=environment, check=True, capture_output=True).stdout)
    points = b"0 1 -1 0 0 1\n0 -1 -1 0 0 1\n"
    words, options = ["rtrace", "-h", "-I", "-ab", "0", "lamp.oct"], {"check": True, "capture_output": True}
    run = subprocess.run(words, input=points, env=environment, **options)
    return [float(line.split()[0]) for line in run.stdout.decode().splitlines()]


whole, half = received((0, 90, 180, 270, 360)), received((90, 180, 270))
print("planes 0 to 360:  to the side of 90 over that of 270:", round(whole[0] / whole[1], 3))
print("planes 90 to 270: to the side of 90 over that of 270:", round(half[0] / half[1], 3))
assert abs(whole[0] / whole[1] - 3) < 0.01, "the behaviour has changed"
assert abs(half[0] / half[1] - 1 / 3) < 0.01, "the behaviour has changed"
PYTHON
echo 'as stated: ies2rad changes the planes of 90 and 270 for each other where a file has no others'
