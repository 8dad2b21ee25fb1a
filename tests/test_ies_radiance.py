"""IES files beside Radiance's ies2rad and rtrace: the same light at points below an asymmetric luminaire."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from luminaire_files import LAMBERTIAN, ies

import radiosity as rd

pyradiance = pytest.importorskip("pyradiance")
LUMENS_PER_WATT = 179.0  # Radiance's
LUMINANCE = (0.2651, 0.6701, 0.0648)  # of its red, green and blue


def radiance(folder: Path, points: np.ndarray) -> np.ndarray:
    """Lux at points that look up, (n,)."""
    root = Path(pyradiance.__file__).parent
    paths = {"PATH": f"{root / 'bin'}{os.pathsep}{os.environ['PATH']}", "RAYPATH": f".{os.pathsep}{root / 'lib'}"}

    def run(*words: str, text: str = "") -> bytes:
        return subprocess.run(
            words, input=text.encode(), cwd=folder, env=os.environ | paths, check=True, capture_output=True
        ).stdout

    run("ies2rad", "-t", "default", "lamp.ies")
    (folder / "lamp.oct").write_bytes(run("oconv", "lamp.rad"))
    text = "".join(f"{x} {y} {z} 0 0 1\n" for x, y, z in points)
    lines = run("rtrace", "-h", "-I", "-ab", "0", "lamp.oct", text=text).decode().splitlines()
    return np.array([line.split() for line in lines], float) @ LUMINANCE * LUMENS_PER_WATT


def lux(lamp: rd.Luminaire, points: np.ndarray) -> np.ndarray:
    """The same here, by the law of the inverse square and the cosine."""
    distance = np.linalg.norm(points, axis=1)
    local = points / distance[:, None] @ lamp.axes.T
    gamma = np.degrees(np.arccos(local[:, 2]))
    plane = np.degrees(np.arctan2(local[:, 1], local[:, 0])) % 360
    web = lamp.web
    rows = [[np.interp(g, web.gamma, row) for row in web.intensity] for g in gamma]
    return np.array([np.interp(c, web.planes, row) for c, row in zip(plane, rows, strict=True)]) * 1.5 / distance**3


@pytest.mark.parametrize("planes", [(0, 45, 90, 135, 180, 225, 270, 360), (0, 90, 180), (0, 30, 60, 90), (90, 135, 225, 270)])
def test_the_same_light_as_radiance(tmp_path, random, planes):
    """Its planes of 90 and 270 are changed for each other where a file begins with 90 (findings/)."""
    rows = random.uniform(50, 300, (len(planes), 1)) * np.array(LAMBERTIAN)
    rows[-1] = rows[0] if planes[-1] == 360 else rows[-1]
    factors = {"lamps": 2, "lumens": 2000.0, "multiplier": 1.5, "ballast": 0.8, "keywords": ["[LAMP] LED warm white"]}
    (tmp_path / "lamp.ies").write_text(ies(rows, horizontal=planes, **factors))
    points = np.column_stack([random.uniform(-2, 2, (12, 2)), np.full(12, -1.5)])
    found = lux(rd.read_luminaire(tmp_path / "lamp.ies", position=(0, 0, 0)), points)
    side = np.array([1, -1 if planes[0] == 90 else 1, 1])
    assert found == pytest.approx(radiance(tmp_path, points * side), rel=1e-3)
