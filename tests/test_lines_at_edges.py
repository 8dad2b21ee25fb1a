"""Lines that meet the edge of two faces, but for rounding, end. In a process of its own: one that does not would never return.

Lines are aimed at points on edges and corners of a maze, from near and from far. Without the rule of short steps (`crossing`)
some went from one wall of a corner to the other and back, without end.
"""

import subprocess
import sys

import pytest

AIMED = """
import numpy as np
import radiosity as rd
from radiosity.device.backend import choose
from radiosity.tracing.geometry import Geometry
geometry = Geometry(rd.subdivide(rd.load_scene("labyrinth-0.1"), cells=1), choose("cpu"))
import drjit as dr
from radiosity.device.backend import upload
from radiosity.tracing.global_lines.chords import walk
from radiosity.tracing.global_lines.crossing import Crossings

types, random, n = geometry.device.types, np.random.default_rng(5), 50_000
corners = geometry.bvh.vertices[geometry.scene.faces]
face, edge = random.integers(len(corners), size=n), random.integers(4, size=n)
share = random.choice([0, 0.25, 0.5, 1, *random.random(3)], size=n)[:, None]
begin, end = corners[face, edge], corners[face, (edge + 1) % 4]
direction = random.normal(size=(n, 3))
direction /= np.linalg.norm(direction, axis=1)[:, None]
origin = begin + (end - begin) * share - direction * random.choice([2.0 ** -1, 4.0, 3e5], size=n)[:, None]
origins, directions = (upload(types.Float, x.astype(np.float32).ravel()) for x in (origin, direction))

def line(index):
    begins, ways = (dr.gather(types.Array3f, x, index) for x in (origins, directions))
    return begins, ways, dr.full(types.Bool, False, dr.width(index)), dr.zeros(types.UInt32, dr.width(index))

found = walk(Crossings(geometry), dr.arange(types.UInt32, n), n, line, 20 * n, coherent=False)
print(len(found.line), np.bincount(found.line).max())
"""


def run(code: str) -> list[int]:
    try:
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=180, check=False)
    except subprocess.TimeoutExpired:
        pytest.fail("lines went back and forth between two faces: they had not ended after three minutes")
    assert done.returncode == 0, done.stderr
    return [int(word) for word in done.stdout.split()]


def test_lines_at_edges_and_corners_end():
    spans, most = run(AIMED)
    assert spans > 50_000  # 1.4 a line
    assert most <= 11  # a straight line meets at most five walls of one direction, and five of the other


def test_the_line_that_did_not_end():
    """The study's line 2 909 955 of Sobol' points met the corner of two walls."""
    code = """
import radiosity as rd
from radiosity.device.backend import choose
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.global_lines.spans import Spans
geometry = Geometry(rd.subdivide(rd.load_scene("labyrinth-0.1"), cells=1), choose("cpu"))
method = rd.Method(lines="global-disc", order="multipath", numbers="sobol", randomisation="shared")
print(len(Spans(geometry, method, 1, 5).draw(0, 2_909_955, 1).one))
"""
    assert run(code) == [3]
