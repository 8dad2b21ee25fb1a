"""Whole numbers that callers and files give."""

from ..errors import MethodError


def whole(value, name: str, least: int) -> int:
    """The number as an int.

    Raises:
        MethodError: it is no whole number, or below the least.
    """
    try:
        good = not isinstance(value, bool) and int(value) == value and value >= least
    except (TypeError, ValueError, OverflowError):
        good = False
    if not good:
        raise MethodError(f"{name} is {value!r}; it must be a whole number of {least} or more")
    return int(value)
