"""Which camera `radiosity render` takes for its options."""

from dataclasses import replace

import pytest

import radiosity as rd
from radiosity.cli.render import Viewpoint, _view
from radiosity.scene import Camera

FIRST, SECOND = Camera((1, 2, 3), (4, 5, 6), (0, 0, 1), 30.0, 100, 50), Camera((7, 8, 9), (1, 1, 1), (0, 1, 0), 60.0, 20, 10)


def view(scene, **options):
    return _view(scene, Viewpoint(**options))


@pytest.fixture
def two():
    return replace(rd.load_scene("room"), cameras=(FIRST, SECOND))


def test_the_scene_s_own(two):
    assert view(two) is None  # the renderer takes the first
    assert view(two, camera=0) == 0
    assert view(two, camera=1) == 1
    assert view(two, camera=7) == view(two, camera=7, fov=20.0) == 7  # which it refuses


def test_changes_are_those_of_the_camera_asked_for(two):
    assert view(two, fov=20.0) == replace(FIRST, fov=20.0)
    assert view(two, camera=1, fov=20.0) == replace(SECOND, fov=20.0)
    assert view(two, camera=1, up="1,0,0") == replace(SECOND, up=(1, 0, 0))
    with pytest.raises(rd.SceneError, match="no camera for --up or --fov"):
        view(replace(two, cameras=()), fov=20.0)


@pytest.mark.parametrize(("name", "up"), [("room", (0, 0, 1)), ("cornell-box", (0, 1, 0))])
def test_one_of_the_user_s_own(name, up):
    """Up is what it is in the scene, unless it is said."""
    scene = rd.load_scene(name)
    assert view(scene, origin="1,2,3", target="4,5,6") == Camera((1, 2, 3), (4, 5, 6), up)
    assert view(scene, origin="1,2,3", target="4,5,6", up="1,0,0", fov=9.0) == Camera((1, 2, 3), (4, 5, 6), (1, 0, 0), 9.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"origin": "0,0,0"}, "go together"),
        ({"target": "0,0,0"}, "go together"),
        ({"camera": 0, "origin": "0,0,0", "target": "1,0,0"}, "not both"),
    ],
)
def test_what_does_not_go_together(two, options, message):
    with pytest.raises(rd.SceneError, match=message):
        view(two, **options)
