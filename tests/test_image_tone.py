"""The scale and the sRGB curve."""

import numpy as np
import pytest

from radiosity import OutputError
from radiosity.image import tone
from radiosity.image.look import Look
from radiosity.scene.formats.textures import decode_srgb


def test_srgb_at_known_values():
    known = {0.0: 0.0, 0.0031308: 0.04044994, 0.18: 0.46135613, 0.2140411: 0.5, 0.5: 0.73535698, 1.0: 1.0, 7.0: 1.0, -1.0: 0.0}
    np.testing.assert_allclose(tone.srgb(np.array(list(known))), list(known.values()), atol=1e-6)
    assert tone.srgb(np.array([np.nan, np.inf])) == pytest.approx([0, 1])


def test_images_are_decoded_by_the_inverse_curve():
    linear = np.concatenate([np.linspace(0, 0.01, 200), np.linspace(0.01, 1, 200)])
    np.testing.assert_allclose(decode_srgb(tone.srgb(linear)), linear, rtol=1e-4, atol=1e-9)
    np.testing.assert_allclose(decode_srgb(np.array([0.02, 0.04, 0.5])), [0.02 / 12.92, 0.04 / 12.92, 0.21404114], rtol=1e-7)


def test_eight_bits_are_rounded():
    assert tone.eight_bits(np.array([0, 0.5 / 255 - 1e-9, 0.5 / 255 + 1e-9, 1])).tolist() == [0, 0, 1, 255]


def test_colours_of_one_two_and_three_bands():
    np.testing.assert_allclose(tone.colours(np.array([[2.0]])), [[2, 2, 2]])
    np.testing.assert_allclose(tone.colours(np.array([[1.0, 3.0]])), [[2, 2, 2]])
    np.testing.assert_allclose(tone.colours(np.array([[1.0, 2.0, 3.0]])), [[1, 2, 3]])


def test_luminance_of_white_is_one():
    assert tone.luminance(np.ones((1, 3)))[0] == pytest.approx(1)


def test_the_automatic_scale_takes_the_percentile_to_the_level(random):
    values = np.arange(1, 101.0)[:, None]
    assert tone.automatic_scale(values) == pytest.approx(tone.LEVEL / tone.PERCENTILE)
    assert tone.automatic_scale(values, np.where(values[:, 0] <= 10, 1.0, 0.0)) == pytest.approx(tone.LEVEL / 10)
    assert tone.automatic_scale(np.array([[0.0], [np.nan]])) == 1
    assert tone.automatic_scale(np.zeros((0, 3))) == 1
    for _ in range(20):  # in whatever order they come
        assert tone.automatic_scale(random.permutation(values)) == pytest.approx(tone.LEVEL / tone.PERCENTILE)


def test_the_automatic_scale_weighs_each_value_by_its_own_area(random):
    """97 % of the area is at or below the percentile's value, however the values are ordered."""
    values, weight = np.array([2.0, 5.0, 9.0]), np.array([0.97, 0.02, 0.01])
    for order in ([0, 1, 2], [2, 1, 0], [1, 2, 0], [1, 0, 2]):
        assert tone.automatic_scale(values[order, None], weight[order]) == pytest.approx(tone.LEVEL / 2)
        heavy = np.array([0.96, 0.02, 0.02])
        assert tone.automatic_scale(values[order, None], heavy[order]) == pytest.approx(tone.LEVEL / 5)
    values, weight = random.random(500) + 0.1, random.random(500)
    scale = tone.automatic_scale(values[:, None], weight)
    for order in (np.argsort(values), random.permutation(500)):
        assert tone.automatic_scale(values[order, None], weight[order]) == pytest.approx(scale)
    level = tone.LEVEL / scale
    share = weight[values <= level].sum() / weight.sum()
    assert tone.PERCENTILE / 100 <= share < tone.PERCENTILE / 100 + 0.01
    assert weight[values < level].sum() / weight.sum() < tone.PERCENTILE / 100


def test_the_automatic_scale_leaves_out_what_is_dark_or_unknown_with_its_weight():
    values = np.array([[0.0], [7.0], [np.nan], [3.0], [np.inf], [-1.0]])
    assert tone.automatic_scale(values, np.array([99.0, 1.0, 99.0, 99.0, 99.0, 99.0])) == pytest.approx(tone.LEVEL / 3)
    assert tone.automatic_scale(values, np.array([99.0, 9.0, 99.0, 1.0, 99.0, 99.0])) == pytest.approx(tone.LEVEL / 7)
    coloured = np.array([[0.1, 0.2, 4.0], [3.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # the strongest channel, not their mean
    assert tone.automatic_scale(coloured) == pytest.approx(tone.LEVEL / 4)
    assert tone.automatic_scale(coloured[:, :2]) == pytest.approx(tone.LEVEL / 1.5)  # two bands are grey, by their mean


def test_a_stop_doubles():
    scales = [
        tone.chosen_scale(Look(exposure=stops, scale=scale), lambda: 0.3) for stops, scale in ((None, None), (1, None), (-2, 8.0))
    ]
    assert scales == [0.3, 0.6, 2.0]


@pytest.mark.parametrize("look", [Look(scale=0), Look(scale=-1), Look(scale=np.nan), Look(exposure=np.inf), Look(exposure=1e6)])
def test_senseless_scales_are_refused(look):
    with pytest.raises(OutputError, match=r"scale is|exposure is"):
        tone.chosen_scale(look, lambda: 1.0)
