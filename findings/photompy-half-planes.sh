#!/usr/bin/env bash
# photompy 0.3.1: an IES file of type C with planes from 0 to 180, whose other half is the mirror. `get_intensity` takes azimuths
# of 0 to 360 degrees, and beyond 180 goes on along the line through the last two planes: at 270 it gives 0 cd in place of 225, at
# 350 minus 100 cd. Nothing is said. `photometry.expanded().get_intensity` is right. The ballast factor of a file is applied nowhere.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'photompy==0.3.1' 'numpy==2.3.5'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import math
import warnings
from importlib.metadata import version
from pathlib import Path

from photompy import IESFile

warnings.simplefilter("error")
GAMMA, PLANES = range(0, 91, 5), (0, 90, 180)


def photometry(ballast):
    """Of a luminaire that is three times as bright towards 0 as towards 180 degrees."""
    rows = [[1000 / math.pi * math.cos(math.radians(g)) * (1 + math.cos(math.radians(c)) / 2) for g in GAMMA] for c in PLANES]
    text = ["IESNA:LM-63-2002", "[TEST] 1", "[TESTLAB] ours", "[ISSUEDATE] today", "[MANUFAC] ours", "TILT=NONE"]
    text += [f"1 1000 1 {len(GAMMA)} {len(PLANES)} 1 2 0 0 0", f"{ballast} 1 30", " ".join(map(str, GAMMA)), " ".join(map(str, PLANES))]
    Path("lamp.ies").write_text("\r\n".join([*text, *(" ".join(f"{value:.3f}" for value in row) for row in rows)]) + "\r\n", newline="")
    return IESFile.read("lamp.ies").photometry


found = photometry(ballast=1)
given = {c: round(float(found.get_intensity(45, c))) for c in (0, 90, 180, 270, 350)}
right = {c: round(float(found.expanded().get_intensity(45, c))) for c in given}
print("photompy", version("photompy"))
print("cd at 45 degrees by azimuth:", given)
print("of expanded():", right)
whole, half = (photometry(ballast).total_optical_power() for ballast in (1, 0.5))
print(f"lm with a ballast factor of 1: {whole:.0f}, of 0.5: {half:.0f}, where 500 is right")
assert given == {0: 338, 90: 225, 180: 113, 270: 0, 350: -100}, "the behaviour has changed"
assert right[270] == 225 and right[350] > 320, "the behaviour has changed"
assert whole == half, "the behaviour has changed"
PYTHON
echo 'as stated: the mirrored half has intensities below zero'
