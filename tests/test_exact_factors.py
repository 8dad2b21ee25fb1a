"""The matrix of a scene from exact form factors and visible shares."""

import numpy as np
import pytest
from enclosures import cube

import radiosity as rd
from radiosity.device.backend import choose
from radiosity.factors.balance import restored
from radiosity.factors.missed import missed
from radiosity.factors.polygons import exchange
from radiosity.factors.polygons.matrix import exact
from radiosity.scene.shapes import quad
from radiosity.tracing.geometry import Geometry
from validation.closed_forms.rectangles import parallel


def geometry_of(scene: rd.Scene, cells: int) -> Geometry:
    return Geometry(rd.subdivide(scene, cells=cells), choose("cpu"))


def test_an_empty_cube_has_the_exact_matrix():
    geometry = geometry_of(cube(), 3)
    patches = geometry.patches
    i, j = (x.ravel() for x in np.indices((54, 54)))
    found = exact(geometry)
    assert (np.diff(found.rows * 54 + found.columns) > 0).all()
    truth = exchange(patches.corners[i], patches.corners[j]).reshape(54, 54) / patches.area[:, None]
    assert found.dense() == pytest.approx(truth, rel=1e-12, abs=1e-15)
    assert found.dense().sum(axis=1) == pytest.approx(np.ones(54), rel=1e-12)
    assert not found.escaped.any()
    assert not found.lost.any()


def test_rows_of_a_maze_close_as_rays_grow():
    """Closed and full of obstacles: what rows lack is the error of the visible shares alone."""
    geometry = geometry_of(rd.load_scene("labyrinth-0.5"), 1)
    area = geometry.patches.area
    errors = [np.sqrt(np.mean((exact(geometry, rays).dense().sum(axis=1) - 1) ** 2)) for rays in (16, 256)]
    assert errors[0] < 0.01
    assert errors[1] < errors[0] / 4
    factors = exact(geometry, 16)
    exchanged = area[:, None] * factors.dense()
    assert exchanged == pytest.approx(exchanged.T, rel=1e-12)
    assert restored(factors, area).dense().sum(axis=1) == pytest.approx(np.ones(70), rel=1e-12)


@pytest.mark.parametrize("back", [rd.Back.ABSORBS, rd.Back.RADIATES, rd.Back.PASSES])  # OPEN is refused
def test_light_goes_through_backs_that_pass_one_way(back):
    """Unit squares at unit distance, the floor's side first, and a sheet half way between them that looks up."""
    quads = [
        quad((0, 0, 0), (1, 0, 0), (0, 1, 0)),
        quad((0, 0, 1), (0, 1, 0), (1, 0, 0)),
        quad((-4, -4, 0.5), (9, 0, 0), (0, 9, 0)),
    ]
    backs = [rd.Back.ABSORBS, rd.Back.ABSORBS, back]
    scene = rd.Scene.from_arrays(np.concatenate(quads), np.arange(12).reshape(3, 4), 0.0, 1.0, back=backs)
    factors = exact(geometry_of(scene, 1))
    dense, passes, radiates = factors.dense(), back == rd.Back.PASSES, back == rd.Back.RADIATES
    below = exchange(quads[0][None], quads[2][None, ::-1])[0]
    assert dense[0, 1] == pytest.approx(parallel(1, 1) if passes else 0, rel=1e-12)
    assert dense[1, 0] == 0
    assert dense[1, 2] == pytest.approx(below, rel=1e-9)
    assert dense[0].sum() == pytest.approx(below if radiates else parallel(1, 1) if passes else 0, rel=1e-9)
    assert factors.lost[0] == pytest.approx(0 if radiates or passes else below, abs=0.01)
    assert dense[0].sum() + factors.lost[0] + factors.escaped[0] == pytest.approx(1, abs=0.01)


def test_shares_that_escape_and_are_lost():
    quads = [quad((0, 0, 0), (1, 0, 0), (0, 1, 0)), quad((0, 0, 1), (1, 0, 0), (0, 1, 0))]  # the upper one looks away
    scene = rd.Scene.from_arrays(np.concatenate(quads), np.arange(8).reshape(2, 4), 0.0, 1.0)
    escaped, lost = missed(geometry_of(scene, 1), 1 << 14)
    assert lost == pytest.approx([parallel(1, 1), 0], abs=1e-3)
    assert escaped == pytest.approx([1 - parallel(1, 1), 1], abs=1e-3)
    single, _ = missed(geometry_of(scene.take(np.array([0])), 1), 1)
    assert single.tolist() == [1]
