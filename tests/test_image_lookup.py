"""From a hit on a face to the value of a patch."""

from types import SimpleNamespace

import numpy as np
import pytest
from image_samples import quad_scene

import radiosity as rd
from radiosity.image.lookup import Lookup

TRIANGLE = rd.Scene.from_arrays([[0, 0, 0], [2, 0, 0], [0.5, 2, 0]], [[0, 1, 2]], 0.5, 0.0, two_sided=True)


def hits(random, scene, m, front=True):
    u, v = random.random((2, m))
    over = ~scene.is_quad[0] & (u + v > 1)
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    return SimpleNamespace(face=np.zeros(m, int), u=u, v=v, front=np.full(m, front), distance=np.ones(m))


def points(scene, hit):
    origin, first, second = (edge[0] for edge in scene.frames)
    return origin + hit.u[:, None] * first + hit.v[:, None] * second


@pytest.mark.parametrize("front", [True, False])
@pytest.mark.parametrize("scene", [quad_scene(two_sided=True), TRIANGLE], ids=["square", "triangle"])
def test_interpolation_reproduces_a_linear_field(random, scene, front):
    patches = rd.subdivide(scene, cells=5)
    look = Lookup(patches, np.zeros((len(patches), 1)))
    vars(look)["at_vertices"] = (look.mesh.vertices @ [1.0, -2.0, 0.5] + 7.0)[:, None]  # in place of smoothed patch values
    hit = hits(random, scene, 500, front)
    values, patch = look(hit)
    np.testing.assert_allclose(values[:, 0], points(scene, hit) @ [1.0, -2.0, 0.5] + 7.0, rtol=1e-12)
    assert (look.patches.is_back[patch] == (not front)).all()


@pytest.mark.parametrize("scene", [quad_scene(), TRIANGLE], ids=["square", "triangle"])
def test_flat_values_are_those_of_the_patch_that_holds_the_point(random, scene):
    patches = rd.subdivide(scene, cells=4)
    hit = hits(random, scene, 300)
    values, patch = Lookup(patches, np.arange(len(patches))[:, None], smooth=False)(hit)
    assert values[:, 0].tolist() == patch.tolist()
    a, b, c, d = (patches.corners[patch][:, k] for k in range(4))
    x = points(scene, hit)
    for start, end in ((a, b), (b, c), (c, d), (d, a)):
        assert (np.cross(end - start, x - start)[:, 2] >= -1e-12).all()


def test_nothing_and_absorbing_backs_have_no_patch():
    patches = rd.subdivide(quad_scene(), cells=2)
    hit = SimpleNamespace(face=np.array([-1, 0, 0]), u=np.full(3, 0.1), v=np.full(3, 0.1), front=np.array([False, False, True]))
    values, patch = Lookup(patches, np.full((4, 1), 3.0))(hit)
    assert patch.tolist() == [-1, -1, 0]
    assert values.ravel().tolist() == [0, 0, pytest.approx(3)]
