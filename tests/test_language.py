"""Docstrings begin with what a thing is or does, and use the words of the glossary (docs/glossary.md)."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

import radiosity

ROOT = Path(radiosity.__file__).parent

# A docstring that begins with one of these words is a fragment: it names neither the thing nor what it does.
FRAGMENTS = (
    "After|And|Are|As|At|Before|Between|But|By|For|From|If|In|Into|Is|It|Its|Like|Likewise|Of|On|Or|Over|Per|So|Than|That|"
    "The others|The same|Their|Then|Those|Through|To|Under|Until|Upon|When|Where|Whether|While|Whose|Why|With|Within|Without"
)
FRAGMENT = re.compile(rf"({FRAGMENTS})\b|\(")  # nor does a shape, such as "(n_patches,) float64", say what an array is

# Words of older versions, and the word of the glossary for each.
OLDER = {
    "ray caster": "BVH",
    "caster": "BVH, first hit",
    "departure": "ray generation",
    "landing": "hit",
    "landings": "hits",
    "lands": "hits",
    "owed": "target count",
    "owes": "target count",
    "sweep": "wavefront",
    "sweeps": "wavefronts",
}


def fragment(docstring: str) -> str | None:
    """Return what is wrong with the beginning of a docstring, or None."""
    return docstring.splitlines()[0] if FRAGMENT.match(docstring) else None


def older(docstring: str) -> str | None:
    """Return the first older word of a docstring with the word to use, or None."""
    found = next((word for word in OLDER if re.search(rf"\b{word}\b", docstring)), None)
    return None if found is None else f"{found}: say {OLDER[found]}"


@cache
def docstrings(source: str) -> tuple[tuple[int, str], ...]:
    """Return line and text of every docstring of a module."""
    kinds = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    nodes = (node for node in ast.walk(ast.parse(source)) if isinstance(node, kinds))
    return tuple((node.body[0].lineno, text) for node in nodes if (text := ast.get_docstring(node)))


def faults(source: str, fault) -> list[tuple[int, str]]:
    """Return line and fault of the docstrings of a module that have one."""
    return [(line, found) for line, text in docstrings(source) if (found := fault(text)) is not None]


def modules() -> list[Path]:
    """Return the modules of the library; the rules hold for the docstrings of all."""
    return sorted(ROOT.rglob("*.py"))


@pytest.mark.parametrize("fault", [fragment, older])
def test_docstrings_say_first_what_a_thing_is_in_the_words_of_the_glossary(fault):
    found = {
        f"{path.relative_to(ROOT)}:{line}: {text}" for path in modules() for line, text in faults(path.read_text("utf-8"), fault)
    }
    assert found == set()


def test_all_folders_are_held_to_the_rules():
    assert len(modules()) > 300
    assert {"algorithms", "cli", "scene", "solution"} <= {path.relative_to(ROOT).parts[0] for path in modules()}


@pytest.mark.parametrize(
    "wrong",
    [
        "Of a wavefront, the lines of all patches.",
        "In a kernel: the patch that a line hits.",
        "As `local_line`, for a loop.",
        "The same, where one replicate needs no division.",
        "(n_patches,) float64, m².",
    ],
)
def test_a_fragment_is_rejected(wrong):
    assert faults(f'def area():\n    """{wrong}"""\n', fragment) == [(2, wrong)]
    assert faults(f'class Area:\n    """Areas of patches."""\n\n    def of(self):\n        """{wrong}"""\n', fragment) == [
        (5, wrong)
    ]


def test_an_older_word_is_rejected():
    assert faults('"""The sweep of all patches."""\n', older) == [(1, "sweep: say wavefront")]


@pytest.mark.parametrize("right", ["Return the areas, (n_patches,) float64, m².", "Offsets of faces.", "Inner products."])
def test_a_whole_sentence_passes(right):
    assert fragment(right) is None
    assert older(right) is None
