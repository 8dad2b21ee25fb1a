"""The scale and the sRGB curve."""

import numpy as np
import pytest

from radiosity import OutputError
from radiosity.image import tone
from radiosity.image.look import Look


def test_srgb_at_known_values():
    known = {0.0: 0.0, 0.0031308: 0.04044994, 0.18: 0.46135613, 0.2140411: 0.5, 0.5: 0.73535698, 1.0: 1.0, 7.0: 1.0, -1.0: 0.0}
    np.testing.assert_allclose(tone.srgb(np.array(list(known))), list(known.values()), atol=1e-6)
    assert tone.srgb(np.array([np.nan, np.inf])) == pytest.approx([0, 1])


def test_eight_bits_are_rounded():
    assert tone.eight_bits(np.array([0, 0.5 / 255 - 1e-9, 0.5 / 255 + 1e-9, 1])).tolist() == [0, 0, 1, 255]


def test_colours_of_one_two_and_three_bands():
    np.testing.assert_allclose(tone.colours(np.array([[2.0]])), [[2, 2, 2]])
    np.testing.assert_allclose(tone.colours(np.array([[1.0, 3.0]])), [[2, 2, 2]])
    np.testing.assert_allclose(tone.colours(np.array([[1.0, 2.0, 3.0]])), [[1, 2, 3]])


def test_luminance_of_white_is_one():
    assert tone.luminance(np.ones((1, 3)))[0] == pytest.approx(1)


def test_the_automatic_scale_takes_the_percentile_to_the_level():
    values = np.arange(1, 101.0)[:, None]
    assert tone.automatic_scale(values) == pytest.approx(tone.LEVEL / tone.PERCENTILE)
    assert tone.automatic_scale(values, np.where(values[:, 0] <= 10, 1.0, 0.0)) == pytest.approx(tone.LEVEL / 10)
    assert tone.automatic_scale(np.array([[0.0], [np.nan]])) == 1


def test_a_stop_doubles():
    scales = [
        tone.chosen_scale(Look(exposure=stops, scale=scale), lambda: 0.3) for stops, scale in ((None, None), (1, None), (-2, 8.0))
    ]
    assert scales == [0.3, 0.6, 2.0]


@pytest.mark.parametrize("look", [Look(scale=0), Look(scale=-1), Look(scale=np.nan), Look(exposure=np.inf), Look(exposure=1e6)])
def test_senseless_scales_are_refused(look):
    with pytest.raises(OutputError, match=r"scale is|exposure is"):
        tone.chosen_scale(look, lambda: 1.0)
