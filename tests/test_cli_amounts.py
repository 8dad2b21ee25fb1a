"""Numbers as people write them."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radiosity.cli import amounts
from radiosity.cli.progress import duration


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", 1),
        ("10M", 10**7),
        ("10m", 10**7),
        ("500k", 500_000),
        ("1e7", 10**7),
        ("1.5M", 1_500_000),
        ("10_000_000", 10**7),
        ("2G", 2 * 10**9),
        ("0.25k", 250),
        (" 7 ", 7),
        ("1E3", 1000),
        ("1 M", 10**6),
    ],
)
def test_counts(text, value):
    assert amounts.count(text) == value
    assert isinstance(amounts.count(text), int)


@pytest.mark.parametrize(
    "text", ["0", "-1", "-10M", "0.5", "1.5", "1e-3", "1e30", "", "ten", "10Q", "nan", "inf", "1,000", "10%", "0x10", "1e999"]
)
def test_no_counts(text):
    with pytest.raises(ValueError, match=f"^'{text}' .*10M, 500k or 1e7"):
        amounts.count(text)


@pytest.mark.parametrize(("text", "value"), [("60", 60), ("0.5", 0.5), ("90s", 90), ("5min", 300), ("5m", 300), ("1.5h", 5400)])
def test_seconds(text, value):
    assert amounts.seconds(text) == value


@pytest.mark.parametrize("text", ["0", "-5", "inf", "nan", "soon", "1d", "5%", ""])
def test_no_seconds(text):
    with pytest.raises(ValueError, match=f"^'{text}' .*5min or 1h"):
        amounts.seconds(text)


@pytest.mark.parametrize(
    ("text", "value"), [("1%", 0.01), ("0.01", 0.01), ("0.5%", 0.005), (".1", 0.1), ("5 %", 0.05), ("1e-3", 0.001)]
)
def test_shares(text, value):
    assert amounts.share(text) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("text", ["0", "0%", "-1%", "100%", "1", "5", "nan", "inf", "1k", "little", ""])
def test_no_shares(text):
    with pytest.raises(ValueError, match=f"^'{text}' .*1% or 0.01"):
        amounts.share(text)


@pytest.mark.parametrize(("text", "value"), [("0.1", 0.1), ("10cm", 0.1), ("5mm", 0.005), ("2m", 2.0)])
def test_lengths(text, value):
    assert amounts.length(text) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf", "1ft", "", "1e999"])
def test_no_lengths(text):
    with pytest.raises(ValueError, match=f"^'{text}' .*metres"):
        amounts.length(text)


def test_numbers():
    assert amounts.numbers("1,-2.5,3e2", 3) == (1.0, -2.5, 300.0)


@pytest.mark.parametrize("text", ["1,2", "1,2,3,4", "a,b,c", "1,2,nan", "1,2,inf", "", "1;2;3"])
def test_no_numbers(text):
    with pytest.raises(ValueError, match=f"^'{text}' is not 3 numbers; write such as 0,1.5,-2"):
        amounts.numbers(text, 3)


@settings(max_examples=200)
@given(st.text(alphabet="0123456789.eEkKmMgG%+-_ xnaif,", max_size=8) | st.text(max_size=6))
def test_any_text_is_a_sound_value_or_a_value_error(text):
    for parse, low, high in ((amounts.count, 1, amounts.LARGEST), (amounts.seconds, 0, math.inf), (amounts.share, 0, 1)):
        try:
            value = parse(text)
        except ValueError:
            continue
        assert math.isfinite(value)
        assert low <= value <= high
        assert value > 0


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "0"),
        (999, "999"),
        (1000, "1k"),
        (12_345, "12.3k"),
        (-5000, "-5k"),
        (1e6, "1M"),
        (2.5e6, "2.5M"),
        (1e9, "1G"),
        (4e9, "4G"),
    ],
)
def test_short(value, text):
    assert amounts.short(value) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.2, "0 s"),
        (59.4, "59 s"),
        (59.6, "1 min 00 s"),
        (185, "3 min 05 s"),
        (3599, "59 min 59 s"),
        (3600, "1 h 00 min"),
        (7800, "2 h 10 min"),
        (-1, "0 s"),
    ],
)
def test_durations(value, text):
    assert duration(value) == text


@pytest.mark.parametrize(("text", "value"), [("1", 1.0), ("-0.5", -0.5), ("100", 100.0), ("-100", -100.0), ("+2", 2.0)])
def test_stops(text, value):
    assert amounts.stops(text) == value


@pytest.mark.parametrize("text", ["100.1", "-101", "1%", "1k", "", "nan", "inf"])
def test_no_stops(text):
    with pytest.raises(ValueError, match="no exposure"):
        amounts.stops(text)
