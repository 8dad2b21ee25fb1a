"""What the contract suites of the axes run: methods that have a value of an axis, found by asking `Method` what goes together.

Nobody writes these methods down. For each process that takes the value there is the plainest method; where a suite wants more,
each method that differs from it in one other choice, and every preset that has the value. So a new member of an axis, a new
process and a new preset are run by the suites as soon as their tables name them.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import cache
from itertools import product

import pytest

import radiosity as rd
from radiosity.method.model import CHOICES
from radiosity.method.options import METHOD

DECIDING = ("equation", "lines", "order", "estimator", "absorption")  # which process runs a method; numbers have their own suite
NUMBERS = ("numbers", "scrambling", "randomisation", "padding")  # likewise
ON = {"switch": True, "flag": True, "share": 0.25, "whole": 2}
OPTIONS = {  # the values of each other option that are not its default; not what changes the speed alone
    name: list(option.values)[1:] if option.kind == "choice" else [ON[option.kind]]
    for name, option in METHOD.items()
    if name not in (*DECIDING, *NUMBERS) and not option.tuning
}
PLAIN = rd.Method()


def _plain_first(choice: str) -> list[str]:
    return sorted(CHOICES[choice], key=lambda value: value != getattr(PLAIN, choice))


@cache
def accepted() -> tuple[rd.Method, ...]:
    """Every method without options that makes sense, the plainest first: those with the fewest choices that are no defaults."""
    found = []
    for values in product(*map(_plain_first, DECIDING)):
        with suppress(rd.MethodError):
            found.append(rd.Method(**dict(zip(DECIDING, values, strict=True))))
    return tuple(sorted(found, key=lambda method: sum(getattr(method, c) != getattr(PLAIN, c) for c in DECIDING)))


def plainest(axis: str, value: str) -> list[rd.Method]:
    """For each process that takes a value of an axis (or an estimator, an absorption), the plainest method."""
    first = {}
    for method in accepted():
        if getattr(method, axis) == value:
            first.setdefault(method.machine, method)
    return list(first.values())


def said(method: rd.Method) -> bool:
    """Whether a method names the absorption that it has without a name: it is the same method, see `test_axis_estimator`."""
    plain = replace(method, absorption="auto")
    return method.absorption in ("rounded", "drawn") and plain.machine == method.machine


def varied(axis: str, value: str) -> list[rd.Method]:
    """The plainest methods, those that differ from one of them in one other choice or option, and the presets."""
    found = plainest(axis, value)
    for method in tuple(found):
        for choice in set(DECIDING) - {axis}:
            for other in _plain_first(choice):
                with suppress(rd.MethodError):
                    changed = replace(method, **{choice: other})
                    found += [] if said(changed) else [changed]
        for option, values in OPTIONS.items():
            for on in values:
                with suppress(rd.MethodError):
                    found.append(replace(method, **{option: on}))
    found += [preset.method for preset in rd.PRESETS.values() if getattr(preset.method, axis) == value]
    return sorted(dict.fromkeys(found), key=str)


def each(of: Callable[[str, str], list[rd.Method]], *axes: str, slow: Callable[[rd.Method], bool] = lambda method: False):
    """Parametrise a test by the ``method`` of every member of some tables, each method once; ``slow`` says which run with the
    slow tests alone."""
    methods = dict.fromkeys(method for axis in axes for value in CHOICES[axis] for method in of(axis, value))
    marked = [pytest.param(method, marks=pytest.mark.slow) if slow(method) else method for method in methods]
    return pytest.mark.parametrize("method", marked, ids=str)
