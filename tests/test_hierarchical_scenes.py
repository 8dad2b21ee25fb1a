"""Hierarchical radiosity against random walks on the same patches, where obstacles stand, backs radiate, absorb and pass."""

from functools import cache

import numpy as np
import pytest

import radiosity as rd
from radiosity.algorithms.hierarchical import REFINEMENTS, Hierarchical, solve_hierarchical
from radiosity.scene.model import Back
from radiosity.scene.shapes import box, quad

EPSILONS = (1e-3, 1e-4, 1e-5)


def difference(patches, found, expected) -> float:
    """Area-weighted root mean square of B - E over that expected, the largest of the bands."""
    area = patches.area[:, None]
    return float(np.sqrt((area * (found - expected) ** 2).sum(0) / (area * (expected - patches.emission) ** 2).sum(0)).max())


WALKED = (("room", 1.0), ("cornell-box", 0.14))


@cache
def walk(name: str, size: float):
    """Patches and their radiosity, within 0.3 %."""
    patches = rd.subdivide(rd.load_scene(name), size=size, powers_of_two=True)
    solution = rd.solve(patches, "random-walk", rays=4_000_000, replicates=4, seed=5)
    assert solution.error < 0.004
    return patches, solution.radiosity


@pytest.fixture
def walked(request):
    return walk(*request.param)


# each refinement and scene is in another pair, too
LONGER = (("room", "error-power"), ("cornell-box", "brightness-factor"), ("cornell-box", "error-radiance"))


# 10 % at the largest epsilon, and at the smallest 3 %: what 16 rays leave of the shadows of patches of this size
@pytest.mark.parametrize(
    ("walked", "refinement"),
    [
        pytest.param(
            scene, refinement, marks=pytest.mark.slow if (scene[0], refinement) in LONGER else (), id=f"{scene[0]}-{refinement}"
        )
        for scene in WALKED
        for refinement in REFINEMENTS
    ],
    indirect=["walked"],
)
def test_random_walks_agree_the_better_the_smaller_epsilon(walked, refinement, geometry_of):
    patches, expected = walked
    errors = []
    for epsilon in EPSILONS:
        result = solve_hierarchical(patches, geometry_of(patches), Hierarchical(epsilon, refinement))
        errors.append(difference(patches, result.radiosity, expected))
    assert errors[0] < 0.10
    assert errors[1] < 0.06
    assert errors[2] < 0.03
    assert errors[2] < 0.75 * errors[0]


@pytest.mark.parametrize(
    "walked",
    [pytest.param(scene, marks=pytest.mark.slow if scene[0] == "room" else (), id=scene[0]) for scene in WALKED],
    indirect=True,
)
def test_more_rays_leave_less(walked, geometry_of):
    """256 rays of a link instead of 16 leave a fourth or less of the error; 1 % is allowed, for the quadrature too."""
    patches, expected = walked
    result = solve_hierarchical(patches, geometry_of(patches), Hierarchical(1e-5, rays=256))
    assert difference(patches, result.radiosity, expected) < 0.01


def screens() -> rd.Scene:
    """A closed box with a light, and in it a triangle that radiates on both sides, a parallelogram invisible from behind, and one
    that absorbs behind."""
    walls = box((0, 0, 0), (3, 2, 2), inward=True)
    triangle = np.array([(0.6, 0.4, 0.3), (1.6, 0.6, 0.5), (0.9, 1.6, 1.2), (0, 0, 0)])
    passing, absorbing = (
        quad((2.0, 0.3, 0.3), (0.2, 1.2, 0.1), (0.0, 0.1, 1.0)),
        quad((1.2, 0.5, 1.6), (0.8, 0, 0), (0, 0.8, 0.1)),
    )
    corners = np.concatenate([*walls, triangle, passing, absorbing])
    faces = np.arange(36).reshape(9, 4)
    faces[6, 3] = -1
    emission = np.zeros((9, 1))
    emission[3], emission[6] = 2.0, 1.0
    return rd.Scene.from_arrays(
        corners,
        faces,
        [0.5] * 6 + [0.7, 0.3, 0.6],
        emission,
        surface=range(9),
        back=[Back.ABSORBS] * 6 + [Back.RADIATES, Back.PASSES, Back.ABSORBS],
        back_reflectance=[0.5] * 6 + [0.2, 0.0, 0.0],
        back_emission=np.zeros((9, 1)),
        names=[f"surface {i}" for i in range(9)],
    )


def test_backs_that_radiate_pass_and_absorb(geometry_of):
    patches = rd.subdivide(screens(), size=0.5, powers_of_two=True)
    assert len(np.unique(patches.face[patches.is_back])) == 1
    walk = rd.solve(patches, "random-walk", rays=4_000_000, replicates=4, seed=5)
    for refinement in REFINEMENTS:
        result = solve_hierarchical(patches, geometry_of(patches), Hierarchical(1e-5, refinement, rays=64))
        assert difference(patches, result.radiosity, walk.radiosity) < 0.02
    power = [
        np.bincount(patches.face * 2 + patches.is_back, patches.area * x[:, 0]) for x in (result.irradiance, walk.irradiance)
    ]
    np.testing.assert_allclose(power[0], power[1], rtol=0.05)  # of each side, the triangle's two among them


def test_same_arguments_same_bits(geometry_of):
    patches = rd.subdivide(rd.load_scene("room"), cells=2, powers_of_two=True)
    one, other, seeded = (
        solve_hierarchical(patches, geometry_of(patches), Hierarchical(1e-3, seed=seed)).radiosity for seed in (0, 0, 1)
    )
    assert np.array_equal(one, other)
    assert not np.array_equal(one, seeded)


def test_it_tells_its_rays_and_can_be_stopped(geometry_of):
    patches = rd.subdivide(rd.load_scene("room"), cells=2, powers_of_two=True)
    told: list[int] = []
    result = solve_hierarchical(patches, geometry_of(patches), Hierarchical(1e-3), told.append)
    assert sum(told) == result.rays > 0

    def stop(rays: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        solve_hierarchical(patches, geometry_of(patches), Hierarchical(1e-3), stop)
