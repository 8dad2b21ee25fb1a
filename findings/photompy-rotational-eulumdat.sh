#!/usr/bin/env bash
# photompy 0.3.1: a EULUMDAT file of a rotationally symmetric luminaire whose list has the angles of all 24 planes, and the
# intensities of one, as the format has it. photompy takes one angle of the list, then the other planes for gamma angles, and
# intensities from the gamma angles on: 1000 lm become -1948 lm. Nothing is said. The same luminaire with a list of one plane is
# right. Files of half and quarter symmetry, whose lists have all planes too, are refused.
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

from photompy import LDTFile

warnings.simplefilter("error")
GAMMA = range(0, 181, 5)
COSINES = [round(1000 / math.pi * max(math.cos(math.radians(gamma)), 0), 3) for gamma in GAMMA]  # cd per 1000 lm


def flux(name, symmetry, planes, stored):
    """The lumens of a cosine luminaire of 1000 lm with so many planes in its list, and the intensities of so many."""
    head = ["Ours", 1, symmetry, planes, 360 // planes if planes > 1 else 0, len(GAMMA), 5, "report", "lamp", "1", name, "today"]
    sizes = [600, 0, 80, 600, 0, 0, 0, 0, 0, 100, 100, 1, 0]
    lamps = [1, 1, "LED", 1000, "3000", "80", 30, *[0.5] * 10]
    angles = [360 * plane // planes for plane in range(planes)]
    lines = [*head, *sizes, *lamps, *angles, *GAMMA, *(COSINES * stored)]
    Path(name).write_text("\r\n".join(map(str, lines)) + "\r\n", newline="")
    return LDTFile.read(name).photometry.total_optical_power()


def refused(name, symmetry, stored):
    try:
        return f"{flux(name, symmetry, 24, stored):.0f} lm"
    except Exception as error:
        return type(error).__name__


one, all_of_them = flux("one.ldt", 1, 1, 1), flux("all.ldt", 1, 24, 1)
print("photompy", version("photompy"))
print(f"a list of one plane: {one:.0f} lm; of 24 planes: {all_of_them:.0f} lm; right is 1000")
half, quarter = refused("half.ldt", 2, 13), refused("quarter.ldt", 4, 7)
print(f"half symmetry: {half}; quarter symmetry: {quarter}")
assert abs(one - 999) < 1 and abs(all_of_them + 1948) < 1, "the behaviour has changed"
assert half == quarter == "LDTDataError", "the behaviour has changed"
PYTHON
echo 'as stated: angles of planes are read as intensities'
