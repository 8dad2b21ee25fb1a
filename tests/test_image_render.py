"""Pictures: values in pixels, exposure, false colours, files."""

import numpy as np
import pytest
from image_samples import plain_hits, quad_scene, solution

import radiosity as rd
from radiosity.device import backend as device
from radiosity.image import render
from radiosity.image.tone import srgb

Image = pytest.importorskip("PIL.Image")

ABOVE = rd.Camera((1, 1, 5), (1, 1, 0), (0, 1, 0), 40.0, 40, 30)


def square(values, **more):
    return solution(rd.subdivide(quad_scene(**more), cells=2), values)


def shown(values, **options):
    return render(square(values), camera=ABOVE, hits=plain_hits, **options)


def test_flat_patches_have_the_colour_of_their_value():
    picture = shown([0.1, 0.2, 0.3, 0.4], smooth=False, scale=2.0, samples=1)
    assert picture.shape == (30, 40, 3)
    assert picture.dtype == np.uint8
    assert (picture[0, 0] == 0).all()
    # patches run right, then up; the picture's rows run down
    expected = np.rint(255 * srgb(np.array([0.6, 0.8, 0.2, 0.4])))
    assert picture[[13, 13, 16, 16], [17, 22, 17, 22], 1].tolist() == expected.tolist()


def test_a_stop_more_doubles_the_light():
    one, two = (shown([0.1] * 4, scale=1.0, exposure=stops)[15, 20, 0] for stops in (0, 1))
    assert [one, two] == np.rint(255 * srgb(np.array([0.1, 0.2]))).tolist()


def test_the_automatic_exposure_does_not_depend_on_the_unit():
    np.testing.assert_array_equal(shown([1, 2, 3, 4]), shown([250, 500, 750, 1000]))


def test_smoothing_passes_between_patches():
    row = shown([0, 1, 0, 1], scale=0.5)[15, 13:27, 0].astype(int)
    assert (np.diff(row) >= 0).all()
    assert len(set(row)) > 8


def test_edges_are_blended_with_the_background():
    rows = shown([1] * 4, scale=1.0, samples=16)[..., 0]
    assert len(set(rows.ravel().tolist())) > 2
    assert (rows.max(), rows.min()) == (255, 0)


def test_absorbing_backs_are_black_and_radiating_ones_are_not():
    below = rd.Camera((1, 1, -5), (1, 1, 0), (0, 1, 0), 40.0, 40, 30)
    with pytest.warns(rd.RadiosityWarning, match="picture is empty"):
        assert not render(square([1] * 4), camera=below, hits=plain_hits, scale=1.0).any()
    seen = render(square([1] * 4 + [0.5] * 4, two_sided=True), camera=below, hits=plain_hits, scale=1.0)
    assert seen[15, 20, 0] == np.rint(255 * srgb(np.array(0.5)))


def test_colours_of_three_bands():
    scene = rd.Scene.from_arrays([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], [[0, 1, 2, 3]], [[0.5, 0.5, 0.5]], 0.0)
    result = solution(rd.subdivide(scene, cells=1), [[1.0, 0.5, 0.0]])
    picture = render(result, camera=ABOVE, hits=plain_hits, scale=1.0)
    assert picture[15, 20].tolist() == [255, 188, 0]
    for band, grey in (("green", 188), (1, 188), (2, 0)):
        assert render(result, camera=ABOVE, hits=plain_hits, scale=1.0, band=band)[15, 20].tolist() == [grey] * 3


def test_unknown_values_are_black_with_one_warning():
    with pytest.warns(rd.RadiosityWarning, match="unknown"):
        picture = shown([np.nan] * 4, scale=1.0)
    assert not picture.any()


def test_png_carries_scale_and_unit(tmp_path):
    render(square([1, 2, 3, 4]), tmp_path / "a.png", camera=ABOVE, hits=plain_hits, scale=0.25)
    with Image.open(tmp_path / "a.png") as picture:
        assert picture.size == (40, 30)
        assert (picture.text["scale"], picture.text["unit"], picture.text["quantity"]) == ("0.25", "W/m²", "radiosity")
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]


@pytest.mark.parametrize("bands", [1, 3, 5])
def test_exr_holds_physical_values(tmp_path, bands):
    import mitsuba as mi

    scene = rd.Scene.from_arrays([[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]], [[0, 1, 2, 3]], np.full((1, bands), 0.5), 0.0)
    result = solution(rd.subdivide(scene, cells=1), 1000.0 * np.arange(1, bands + 1))
    before = mi.variant()
    values = render(result, tmp_path / "a.exr", camera=ABOVE, hits=plain_hits)
    with device.bitmaps():
        read = np.array(bitmap := mi.Bitmap(str(tmp_path / "a.exr")))
    assert mi.variant() == before
    np.testing.assert_array_equal(read.reshape(30, 40, bands), values)
    np.testing.assert_allclose(values[15, 20], 1000.0 * np.arange(1, bands + 1))
    assert (values[0, 0] == 0).all()
    assert bitmap.metadata()["unit"] == "W/m²"


def test_size_follows_the_camera_or_one_side():
    assert shown([1] * 4, width=80, samples=1).shape == (60, 80, 3)
    assert shown([1] * 4, height=15, samples=1).shape == (15, 20, 3)
    assert shown([1] * 4, width=10, height=10, samples=1).shape == (10, 10, 3)


def test_real_lines_agree_with_plain_ones():
    result = solution(rd.subdivide(rd.load_scene("cornell-box"), cells=2))
    real, plain = (render(result, width=60, samples=2, **more).astype(int) for more in ({}, {"hits": plain_hits}))
    assert (np.abs(real - plain).max(axis=2) <= 1).mean() > 0.995


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"samples": 0}, "samples is 0"),
        ({"quantity": "light"}, "quantity 'light' does not exist; known are radiosity"),
        ({"band": "infrared"}, "band 'infrared'"),
        ({"band": 1}, "band '1' does not exist; known are grey"),
        ({"camera": 3}, "camera 3 does not exist"),
        ({"false_color": True, "range": (2, 1)}, "range is 2.0 to 1.0"),
        ({"false_color": True, "range": (0, 1), "log": True}, "above 0"),
        ({"false_color": True, "range": "wide"}, "two numbers"),
        ({"false_color": True, "color_map": "no such"}, "colour map"),
        ({"path": "x.bmp"}, "unknown output format"),
    ],
)
def test_senseless_options_are_refused(options, message):
    with pytest.raises(rd.OutputError, match=message):
        render(square([1] * 4), **{"camera": ABOVE, "hits": plain_hits, **options})
