"""Percentages and numbers of reports, where some may be unknown."""

import math

UNKNOWN = "?"


def percent(share: float, form: str = ".2%") -> str:
    """``1.23%``, or ``?`` where it is unknown (NaN) or has no bound."""
    return format(share, form) if math.isfinite(share) else UNKNOWN


def number(value: float, form: str = ".4g") -> str:
    """``1.234``, or ``?`` where it is unknown (NaN)."""
    return UNKNOWN if math.isnan(value) else format(value, form)
