#!/usr/bin/env bash
# eulumdat-ies 1.1.0: a EULUMDAT file whose lamp set has two lamps becomes an IES file with twice its light. The flux of a lamp
# set is that of all its lamps together, and the intensities are per 1000 lm of it. The planes of the IES file end before 360
# degrees, which LM-63 does not allow. Nothing is said.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'eulumdat-ies==1.1.0' 'eulumdat-py==1.0.0'
cd "$folder"
"$folder/venv/bin/python" - <<'PYTHON'
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

gamma, planes, flux, intensity = (0, 45, 90), (0, 90, 180, 270), 3000.0, 100.0  # 100 cd per 1000 lm in all directions down


def peak(lamps):
    """The candela of an IES file, in all directions alike, that a set of so many lamps becomes."""
    head = ["Ours", 3, 0, len(planes), 90, len(gamma), 45, "report", "lamp", "1", "lamp.ldt", "today"]
    sizes = [600, 600, 80, 0, 0, 0, 0, 0, 0, 100, 100, 1, 0]
    lines = [*head, *sizes, 1, lamps, "LED", flux, "3000", "80", 30, *[0.5] * 10, *planes, *gamma, *[intensity] * 12]
    Path("lamp.ldt").write_text("\r\n".join(map(str, lines)) + "\r\n", newline="")
    program = Path(sys.executable).parent / "ldt-to-ies"
    subprocess.run([program, "lamp.ldt"], check=True, capture_output=True, env={"PYTHONIOENCODING": "utf-8", "LC_ALL": "C.UTF-8"})
    words = Path("lamp.ies").read_text().split("TILT=NONE")[1].split()
    vertical, horizontal = int(words[3]), int(words[4])
    angles = [float(word) for word in words[13 + vertical : 13 + vertical + horizontal]]
    factor, candela = float(words[2]) * float(words[10]), [float(word) for word in words[13 + vertical + horizontal :]]
    return factor * max(candela), angles


print("eulumdat-ies", version("eulumdat-ies"))
(one, angles), (two, _) = peak(1), peak(2)
print(f"one lamp of 3000 lm: {one:g} cd; two lamps of 3000 lm together: {two:g} cd; right is {intensity * flux / 1000:g} cd")
print("planes of the IES file:", angles)
assert one == 300 and two == 600, "the behaviour has changed"
assert angles[-1] < 360, "the behaviour has changed"
PYTHON
echo 'as stated: the number of lamps multiplies the light'
