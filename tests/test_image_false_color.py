"""False colours and their legend."""

from dataclasses import replace

import numpy as np
import pytest
from image_samples import plain_hits, quad_scene, solution

import radiosity as rd
from radiosity.image import false_color, legend, render
from radiosity.image.false_color import automatic_limits
from radiosity.image.picture import take
from radiosity.image.quantity import choose

matplotlib = pytest.importorskip("matplotlib")

ABOVE = rd.Camera((1, 1, 5), (1, 1, 0), (0, 1, 0), 40.0, 400, 300)
RESULT = solution(rd.subdivide(quad_scene(), cells=2), [1.0, 2.0, 4.0, np.nan])


def picture(**options):
    return render(RESULT, **{"camera": ABOVE, "hits": plain_hits, "samples": 1, "smooth": False, "false_color": True, **options})


def shades(values):
    return matplotlib.colormaps["viridis"](values)[:, :3] * 255


def test_colours_are_those_of_the_map_and_the_legend_stands_beside():
    result = picture(range=(0, 4))
    assert result.shape[0] == 300
    assert 460 < result.shape[1] < 560
    np.testing.assert_allclose(result[[160, 160, 140], [190, 210, 190]], shades([0.25, 0.5, 1.0]), atol=0.51)
    assert result[140, 210].tolist() == [128, 128, 128]  # unknown
    assert not result[5, 5].any()  # nothing there
    assert (result[:, 400:].reshape(-1, 3).max(axis=0) == 255).all()


@pytest.mark.parametrize(
    ("limits", "arrow"),
    [((0.5, 8), "neither"), ((1, 4), "neither"), ((1, 3), "max"), ((2, 4), "min"), ((2, 3), "both"), (None, "neither")],
)
def test_the_legend_has_an_arrow_where_values_lie_beyond(monkeypatch, limits, arrow):
    """Of the values 1, 2 and 4; the unknown one is beyond nothing."""
    drawn, found = legend.drawn, []

    def watched(norm, shades, label, extend, *size):
        found.append(extend)
        return drawn(norm, shades, label, extend, *size)

    monkeypatch.setattr(legend, "drawn", watched)
    picture(range=limits)
    assert found == [arrow]


@pytest.mark.parametrize("quantity", ["radiosity", "irradiance"])
@pytest.mark.parametrize("reflectance", [0.5, 0.0])
def test_a_value_of_0_is_grey_where_no_line_came(monkeypatch, quantity, reflectance):
    """Patches 0 and 1 are 0, and no line met patch 0. The radiosity of what reflects nothing is known to be 0."""
    scene = replace(quad_scene(), reflectance=np.array([[reflectance]]))
    found, titles = solution(rd.subdivide(scene, cells=2), [0.0, 0.0, 2.0, 4.0]), []
    legend = false_color.Palette.legend
    monkeypatch.setattr(false_color.Palette, "legend", lambda self, *rest: titles.append(rest[0]) or legend(self, *rest))
    pixels = render(found, camera=ABOVE, hits=plain_hits, samples=1, smooth=False, quantity=quantity, false_color=True)
    known = quantity == "radiosity" and reflectance == 0
    assert (pixels[160, 190].tolist() == [128, 128, 128]) != known
    assert ("(grey: unknown)" in titles[0]) != known
    np.testing.assert_allclose(pixels[160, 210], shades([0.0])[0], atol=0.51)


def test_logarithmic_scale():
    result = picture(range=(1, 16), log=True)
    np.testing.assert_allclose(result[[160, 160, 140], [190, 210, 190]], shades([0.0, 0.25, 0.5]), atol=0.51)


@pytest.mark.parametrize("quantity", ["irradiance", "standard_error", "irradiance_standard_error"])
def test_quantities(quantity):
    factor = {"irradiance": 2, "standard_error": 0.1, "irradiance_standard_error": 0.2}[quantity]
    np.testing.assert_array_equal(picture(quantity=quantity, range=(0, 4 * factor))[:, :400], picture(range=(0, 4))[:, :400])


def test_the_relative_error_is_in_percent():
    result = picture(quantity="relative_error", range=(0, 20))
    np.testing.assert_allclose(result[[160, 160, 140], [190, 210, 190]], shades([0.5, 0.5, 0.5]), atol=0.51)


def test_automatic_limits():
    values = np.append(np.arange(1, 101.0), np.nan)
    assert automatic_limits(values, False) == (0, pytest.approx(99.01))
    assert automatic_limits(values, True) == (1, pytest.approx(99.01))
    assert automatic_limits(np.append(values, 1e-9), True)[0] == pytest.approx(99 / 1e4, rel=0.01)
    assert automatic_limits(np.full(3, 5.0), True) == (0.5, 5.0)
    assert automatic_limits(np.zeros(3), False) == (0, 1)
    assert automatic_limits(values, False, top=95) == (0, pytest.approx(95.05))


def test_small_bright_patches_set_no_range():
    """A hundred small patches beside a lamp are a thousandth of the area; those of the light elsewhere are five."""
    values, area = np.append(np.full(100, 500.0), np.arange(1, 6.0)), np.append(np.full(100, 1e-5), np.full(5, 0.2))
    assert automatic_limits(values, False)[1] == 500
    assert automatic_limits(values, False, area) == (0, 5)


def test_the_legend_tells_where_an_automatic_range_ends(monkeypatch):
    labels, legend = [], false_color.Palette.legend
    monkeypatch.setattr(false_color.Palette, "legend", lambda *given: labels.append(given[1]) or legend(*given))
    taken = take(RESULT, choose(RESULT, single=True), ABOVE, samples=1, hits=plain_hits)
    for options in ({"top": 60}, {"top": 60, "limits": (0, 3)}, {"top": 100}):
        false_color.colour(taken, title="radiosity", unit="W/m²", **options)
    assert labels == [
        f"radiosity (grey: unknown) [W/m²]{told}" for told in ("; arrow: brighter than 60 % of the view without lamps", "", "")
    ]


@pytest.mark.parametrize(
    "options",
    [{"range": (5, 5)}, {"range": (0, 5), "log": True}, {"color_map": "nothing"}, {"false_color": False, "exposure": 1000}],
)
def test_senseless_options_are_refused_before_a_line_is_traced(options):
    def never(*lines):
        raise AssertionError("a line was traced")

    with pytest.raises(rd.OutputError, match=r"range is|colour map|exposure is"):
        picture(hits=never, **options)


@pytest.mark.parametrize("size", [1e-9, 1e9])
def test_no_factor_stands_beside_a_legend(size):
    """Numbers are written out at each mark, such as 2e-10; left of the bar nothing is drawn."""
    legend = false_color.Palette(0.0, 1.2 * size).legend("radiosity [W/m²]", np.array([0.5]) * size, 300)
    assert (legend[:, :10] == 255).all()
    assert (legend < 100).any()


@pytest.mark.parametrize(("low", "high"), [(0.062, 0.0622), (20000.0, 20000.1), (0.0, 1.0)])
def test_long_numbers_push_no_text_over_the_edge(low, high):
    """The title ends before the right edge, which is white, however long the numbers are."""
    drawn = false_color.Palette(low, high).legend("irradiance [W/m²]", np.array([low]), 240)
    assert (drawn[:, -3:] == 255).all()
    assert (drawn[:, -30:] < 100).any()


@pytest.mark.parametrize("base", [1.0, 2e4, 1e6, 1e-9])
def test_marks_of_a_narrow_range_have_unlike_numbers(monkeypatch, base):
    """Four ten-millionths of a value are drawn apart, and so are the numbers of the marks (pyGIMLi's issue 48)."""
    found, numbers = [], legend.numbers
    monkeypatch.setattr(legend, "numbers", lambda values: found.append(numbers(values)) or found[-1])
    false_color.Palette(base, base * (1 + 4e-7)).legend("light [lx]", np.ones(1), 240)
    marks = found[-1]
    assert len(marks) > 2
    assert len(set(marks)) == len(marks)


def test_letters_of_a_legend_grow():
    """Dark pixels of the letters, beside a bar that is as high as before."""
    small, large = (false_color.Palette(0, 1).legend("light [lx]", np.ones(1), 600, size) for size in (1.0, 2.0))
    assert len(small) == len(large) == 600
    assert (large < 100).all(axis=2).sum() > 2 * (small < 100).all(axis=2).sum()


@pytest.mark.parametrize("log", [False, True])
def test_lamps_set_no_range(log):
    """A wall beside a lamp that is 25 times as bright has the top of the map, as the lamp has."""
    vertices = [[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0], [2, 0, 0], [2, 2, 0]]
    scene = rd.Scene.from_arrays(vertices, [[0, 1, 2, 3], [1, 4, 5, 2]], 0.5, [50.0, 0.0])
    result = render(
        solution(rd.subdivide(scene, cells=1), [50.0, 2.0]),
        camera=ABOVE,
        hits=plain_hits,
        samples=1,
        smooth=False,
        false_color=True,
        log=log,
    )
    np.testing.assert_allclose(result[[150, 150], [160, 240]], shades([1.0, 1.0]), atol=0.51)


def test_file(tmp_path):
    from PIL import Image

    result = picture(path=tmp_path / "a.png", quantity="irradiance")
    with Image.open(tmp_path / "a.png") as file:
        np.testing.assert_array_equal(np.asarray(file), result)
        assert file.text["quantity"] == "irradiance"
    assert (tmp_path / "a.png").stat().st_size > 3000


def test_false_colours_are_no_exr(tmp_path):
    with pytest.raises(rd.OutputError, match=r"write false colours to a \.png"):
        picture(path=tmp_path / "a.exr")
    assert not list(tmp_path.iterdir())


def test_the_legend_of_a_scene_in_lumens_says_illuminance():
    scene = replace(rd.load_scene("room"), photometric=True)
    found = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=5_000, replicates=2)
    assert (choose(found, "irradiance").title, choose(found, "irradiance").unit) == ("illuminance", "lx")
    plain = rd.solve(rd.subdivide(replace(scene, photometric=False), cells=1), "random-walk", rays=5_000, replicates=2)
    assert choose(plain, "irradiance").title == "irradiance"
