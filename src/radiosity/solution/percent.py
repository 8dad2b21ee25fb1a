"""Percentages and numbers of reports, where some may be unknown."""

import math

UNKNOWN = "?"


def percent(share: float, form: str = ".2%") -> str:
    """Return a text such as ``1.23%``, or ``?`` where the share is unknown (NaN) or has no bound."""
    return format(share, form) if math.isfinite(share) else UNKNOWN


def number(value: float, form: str = ".4g") -> str:
    """Return a text such as ``1.234``, or ``?`` where the value is unknown (NaN)."""
    return UNKNOWN if math.isnan(value) else format(value, form)


def margin(value: float) -> str:
    """Return a text of one significant digit, such as ``30`` or ``0.02``, or ``?`` where the value is unknown (NaN)."""
    return UNKNOWN if math.isnan(value) else format(float(f"{value:.1g}"), ".12g")
