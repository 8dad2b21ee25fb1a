"""The table of costs of coherent firing: on which processors packets of like lines are faster, and from how many lines on.

It is a table, and not a measurement before a run, since what a line meets may depend on its packet: like machines must give like
bits. The figures are those of docs/performance.md. Where nobody has measured, no packets are fired.
"""

import warnings
from typing import Any

from ..device.instructions import instructions
from ..errors import RadiosityWarning
from ..sampling.numbers import strata

ALWAYS = "always"  # in place of True: packets wherever lines fill boxes, on any processor
NEVER = None
NAMES = {"avx512": "AVX-512", "avx2": "AVX2", "avx": "AVX", "neon": "NEON", "cuda": "a GPU"}
# lines of a patch in the smallest rounds that are traced in packets (`rounds`); `NEVER`: packets lose, whatever the number
FIRING: dict[str, int | None] = {"avx512": strata.lines(*strata.SIZES[0])}
GATHER: dict[str, int | None] = {"avx512": NEVER, "avx2": NEVER}  # packets always have 16 lines there: 0 where they gain


def fewest_lines(method: Any, device: str) -> int | None:
    """Return from how many lines of a patch on a method fires packets on this machine; None where it fires none.

    Args:
        method: a `Method` or `Baseline`.
        device: the name of the device that lines are traced on.
    """
    choice = getattr(method, "coherent", False)
    if not choice:
        return None
    return 0 if choice == ALWAYS else _table(method).get(_kind(device))


def facts(method: Any, device: str) -> dict[str, str]:
    """Return what the provenance says of packets, and runs that go on must share; {} where it follows from the choices."""
    if getattr(method, "coherent", False) is not True:
        return {}
    fewest = fewest_lines(method, device)
    return {"packets": "none" if fewest is None else f"from {fewest} lines a patch"}


def tell_of_none(method: Any, device: str) -> None:
    """Warn where a method is to trace similar lines together, and this machine would be slower by it."""
    if getattr(method, "coherent", False) is not True or fewest_lines(method, device) is not None:
        return
    kind = _kind(device)
    with_it = f"with {NAMES[kind]}" if kind in NAMES else "on this processor"
    why = "packets of lines take longer" if kind in _table(method) else "nobody has measured whether packets of lines pay"
    warnings.warn(
        f"coherent: no packets are fired, since {with_it} {why} (docs/performance.md); lines are traced as without it, as fast. "
        'In Python coherent="always" fires them',
        RadiosityWarning,
        stacklevel=2,
    )


def _table(method: Any) -> dict[str, int | None]:
    return GATHER if method.machine == "gather" else FIRING


def _kind(device: str) -> str:
    return instructions() if device == "cpu" else device
