"""Tests of which some cases run always, and the rest among the slow tests."""

import pytest


def some(names, more):
    """Some of many cases, and the rest among the slow tests."""
    return pytest.mark.parametrize("name", [*names, *(pytest.param(name, marks=pytest.mark.slow) for name in more)])
