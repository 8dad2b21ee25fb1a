"""The table of options is what everything tells of them: fields, docstrings, help, errors and docs/methods.md."""

import inspect
import os
import subprocess
import sys
import textwrap
from dataclasses import fields, replace
from pathlib import Path

import pytest
from members import accepted

import radiosity as rd
from radiosity.algorithms.firing.orders import FIRED
from radiosity.algorithms.table import ALGORITHMS
from radiosity.cli.solve import solve
from radiosity.factors.solvers import SOLVERS
from radiosity.factors.sources import ROWS
from radiosity.method.combinations import FIRING_ORDERS, GLOBAL_ORDERS, ITERATIONS, WALK_ORDERS
from radiosity.method.option import Option
from radiosity.method.options import BASELINE, METHOD
from radiosity.method.schemes import SCHEMES

PAGE = Path(__file__).parents[1] / "docs" / "methods.md"
OF_CHOICES = {"gathering"}  # algorithms that no preset is run by, but one of its estimators
TABLES = {rd.Method: METHOD, rd.Baseline: BASELINE}
EVERY = [pytest.param(cls, option, id=name) for cls, table in TABLES.items() for name, option in table.items()]
WRONG = {
    "choice": ("none such", ["a list"], None),
    "switch": ("yes", 1, None),
    "flag": ("yes", 1, None),
    "whole": (0, -1, 2.0, True, "4", 2**40),
    "share": (-0.1, 1, 1.5, float("nan"), float("inf"), True, "10%", None),
}


@pytest.mark.parametrize("cls", TABLES)
def test_each_option_has_a_field_and_each_field_an_option(cls):
    assert [field.name for field in fields(cls)] == list(TABLES[cls])
    assert all(name == option.name for name, option in TABLES[cls].items())
    assert not set(METHOD) & set(BASELINE)  # they are keywords of `solve` side by side


@pytest.mark.parametrize(("cls", "option"), EVERY)
def test_the_docstring_says_what_the_help_says(cls, option):
    words = " ".join(inspect.getdoc(cls).split())
    assert f" {option.name}: {option.about}".replace("`", "``") in words
    assert option.details.replace("`", "``") in words


@pytest.mark.parametrize(("cls", "option"), EVERY)
def test_what_an_option_does_not_take_is_refused_by_name(cls, option):
    assert option.kind in WRONG
    for value in WRONG[option.kind]:
        if value is None and option.optional:
            continue
        with pytest.raises(rd.MethodError, match=f"^{option.name} .*(known are|must be|it is the share)"):
            replace(cls(), **{option.name: value})
    for value in option.values:
        option.check(value)
    option.check(getattr(cls(), option.name))


def test_bounds_of_numbers():
    for name, least, most in (("resolution", 1, 2048), ("samples", 1, 65535)):
        BASELINE[name].check(least)
        BASELINE[name].check(most)
        with pytest.raises(rd.MethodError, match=f"from 1 to {most}"):
            BASELINE[name].check(most + 1)
    METHOD["first_shot"].check(0)
    with pytest.raises(rd.MethodError, match="epsilon is 0; it must be a number above 0 and below 1"):
        BASELINE["epsilon"].check(0)


def test_a_choice_of_a_baseline_belongs_to_the_schemes_that_its_option_names():
    others = {"choice": lambda option: list(option.values)[-1], "switch": lambda _: False, "flag": lambda _: True}
    others |= {"whole": lambda _: 2, "share": lambda _: 0.5}
    for scheme in SCHEMES:
        for name, option in BASELINE.items():
            if name in ("scheme", "resolution", "rotated"):  # those of hemicubes want these factors, too
                continue
            if scheme in option.schemes:
                assert getattr(rd.Baseline(scheme, **{name: others[option.kind](option)}), name) is not None
            else:
                with pytest.raises(rd.MethodError, match=f"^{name}: not a choice of {scheme}"):
                    rd.Baseline(scheme, **{name: others[option.kind](option)})


def test_what_the_tables_name_is_there():
    """Names and meanings are told by `method`, and what they stand for is in folders above it."""
    assert set(FIRED) == set(FIRING_ORDERS)
    assert set(METHOD["order"].values) == {*FIRING_ORDERS, *WALK_ORDERS, *ITERATIONS, *GLOBAL_ORDERS, "gather"}
    assert set(BASELINE["solver"].values) == set(SOLVERS)
    assert set(BASELINE["factors"].values) == set(ROWS)
    machines = {method.machine for method in accepted()} | {rd.Baseline(scheme).machine for scheme in SCHEMES}
    assert machines == set(ALGORITHMS) == {preset.method.machine for preset in (rd.PRESETS | rd.BASELINES).values()} | OF_CHOICES


def test_help_has_every_option_and_says_what_the_table_says():
    """In a process of its own: what writes the help keeps the width of the terminal that it has seen first."""
    words, environment = [sys.executable, "-m", "radiosity", "solve", "--help"], {**os.environ, "COLUMNS": "400"}
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True, encoding="utf-8")
    told = " ".join(done.stdout.split())
    for option in (METHOD | BASELINE).values():
        if option.name == "scheme":  # the methods choose it
            continue
        flag = f"--{option.name.replace('_', '-')}"
        also = f" --no-{flag[2:]}" if option.kind == "switch" else {"choice": " STR", "whole": " INT", "share": " FLOAT"}
        also = also if isinstance(also, str) else also.get(option.kind, "")
        assert f"{flag}{also} {option.about.replace('`', '')} │" in told


def test_the_command_has_few_parameters():
    """Options are in groups, each a dataclass."""
    assert len(inspect.signature(solve).parameters) <= 10


def entry(option: Option, default) -> str:
    """The item of a list of options in docs/methods.md."""
    taken = {"switch": "True or False", "flag": "True or False", "whole": f"1 to {option.most}", "share": "a number below 1"}
    first = [taken["flag"]] if option.kind == "flag" else []
    values = ", ".join(first + [f"`{value}`" for value in option.values]) or taken[option.kind]
    of = f" (of {', '.join(option.schemes)})" if option.schemes else ""
    text = f"`{option.name}`{of}: {values}; default `{default}`. {option.about} {option.details}".strip()
    return textwrap.fill(text, 118, initial_indent="- ", subsequent_indent="  ", break_on_hyphens=False)


@pytest.mark.parametrize("cls", TABLES)
def test_the_page_lists_the_options(cls):
    """Where it does not, what the page must hold is in the message."""
    listed = "\n".join(entry(option, getattr(cls(), option.name)) for option in TABLES[cls].values())
    assert listed in PAGE.read_text(encoding="utf-8"), f"docs/methods.md must hold:\n{listed}"
