#!/usr/bin/env bash
# Radiance's ies2rad (pyradiance 1.3.1) looks the text of [LAMP] up in its table of lamps, and takes the first entry whose word
# stands in it. "LED warm white 3000 K" meets an entry for fluorescent tubes: its depreciation dims the luminaire to 0.85, and its
# colour is that of the tube. The same file with "[LAMP] LED" gives what its candela say. ies2rad writes a comment into the .rad
# file, and nothing to the terminal. With "-t default" both files give the same.
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


def received(lamp, *options):
    """Irradiance in three bands 1 m below a luminaire of 1000 cd, weighted as Radiance does for light, and what was said."""
    numbers = ["1 -1 1 3 1 1 2 0.01 0.01 0", "1 1 10", "0 45 90", "0", "1000 1000 1000"]
    Path("lamp.ies").write_text("\n".join(["IESNA:LM-63-2002", f"[LAMP] {lamp}", "TILT=NONE", *numbers]) + "\n")
    run = subprocess.run(["ies2rad", *options, "lamp.ies"], env=environment, check=True, capture_output=True)
    Path("lamp.oct").write_bytes(subprocess.run(["oconv", "lamp.rad"], env=environment, check=True, capture_output=True).stdout)
    words = ["rtrace", "-h", "-I", "-ab", "0", "lamp.oct"]
    out = subprocess.run(words, input=b"0 0 -1 0 0 1\n", env=environment, check=True, capture_output=True).stdout
    bands = [float(word) for word in out.split()]
    return sum(weight * band for weight, band in zip((0.265, 0.67, 0.065), bands, strict=True)), bands, run.stderr


plain, _, _ = received("LED")
named, bands, said = received("LED warm white 3000 K")
default, _, _ = received("LED warm white 3000 K", "-t", "default")
print(f"[LAMP] LED warm white 3000 K: {named / plain:.3f} of the light of [LAMP] LED; red over blue {bands[0] / bands[2]:.2f}")
print(f"with -t default: {default / plain:.3f}; said: {said!r}")
assert abs(named / plain - 0.85) < 0.01, "the behaviour has changed"
assert abs(default / plain - 1) < 0.001, "the behaviour has changed"
assert not said, "the behaviour has changed"
PYTHON
echo 'as stated: the name of a lamp changes its light'
