"""The options of false colours that several commands share."""

from typing import Protocol

from ..errors import OutputError
from . import amounts


class FalseColours(Protocol):
    """Options of false colours."""

    @property
    def false_color(self) -> bool: ...

    @property
    def limits(self) -> str | None: ...

    @property
    def log(self) -> bool: ...

    @property
    def color_map(self) -> str | None: ...


def range_of(options: FalseColours) -> tuple[float, float] | None:
    """Return the limits as numbers.

    Raises:
        OutputError: options of false colours are given without them.
    """
    given = {"--range": options.limits is not None, "--log": options.log, "--color-map": options.color_map is not None}
    idle = [name for name, there in given.items() if there]
    if idle and not options.false_color:
        raise OutputError(f"{' and '.join(idle)}: for false colours only; add --false-color")
    low_high = None if options.limits is None else amounts.numbers(options.limits, 2)
    return None if low_high is None else (low_high[0], low_high[1])
