"""The table of mutations fits the code: a row makes one mistake that Python accepts, and names tests that there are."""

import ast
import builtins
import sys
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest
from import_graph import walked

import radiosity

TESTS = Path(__file__).resolve().parent
SOURCE = Path(radiosity.__file__).parent
sys.path.insert(0, str(TESTS / "mutations"))
from table import MISTAKES, Mistake  # noqa: E402


def faults(mistake: Mistake, text: str) -> list[str]:
    """What is wrong with a row, of a file that holds ``text``."""
    if text.count(mistake.old) != 1:
        return [f"its text stands {text.count(mistake.old)} times in the file"]
    try:
        after = statements(text.replace(mistake.old, mistake.new))
    except SyntaxError as error:
        return [f"is no Python ({error})"]
    if alike(unmistaken(text), after):
        return ["changes no code"]
    unknown = set().union(*(one.read for one in after)).difference(*(one.bound for one in after), dir(builtins), {"__file__"})
    return [f"reads names that the file does not have: {', '.join(sorted(unknown))}"] if unknown else []


class Statement(NamedTuple):
    """A statement of a file at its top level: its syntax tree, and the names that it reads and gives to something."""

    tree: ast.AST
    read: set[str]
    bound: set[str]


def alike(some: list[Statement], others: list[Statement]) -> bool:
    """Whether statements are the same code. What has the same source is one `Statement`: most are not compared."""
    return len(some) == len(others) and all(a is b or same(a.tree, b.tree) for a, b in zip(some, others, strict=True))


def same(a: object, b: object) -> bool:
    """Whether two syntax trees, or parts of them, are the same but for where they stand in a file."""
    if type(a) is not type(b):
        return False
    if isinstance(a, ast.AST):
        return all(same(getattr(a, field, None), getattr(b, field, None)) for field in a._fields)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(same, a, b))
    return repr(a) == repr(b)


KNOWN: dict[tuple[str, int, int], Statement] = {}  # by their source: a row changes one of the many of its file


def statements(text: str) -> list[Statement]:
    """The statements of a file."""
    lines, found = text.split("\n"), []
    for node in ast.parse(text).body:
        first = min(part.lineno for part in (node, *getattr(node, "decorator_list", ())))
        source = "\n".join(lines[first - 1 : node.end_lineno]), node.col_offset, node.end_col_offset
        if source not in KNOWN:
            KNOWN[source] = Statement(node, read(node), bound(node))
        found.append(KNOWN[source])
    return found


unmistaken = cache(statements)


def bound(tree: ast.AST) -> set[str]:
    """Names that a statement gives to something."""
    found = set()
    for node in walked(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            found |= {(alias.asname or alias.name).split(".")[0] for alias in node.names}
        elif isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
            found.add(node.id)
        elif isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.arg):
            found.add(node.arg)
        elif isinstance(node, ast.ExceptHandler) and node.name:
            found.add(node.name)
    return found


def read(tree: ast.AST) -> set[str]:
    """Names that a statement reads."""
    return {node.id for node in walked(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load)}


def missing(test: str) -> bool:
    """Whether there is no such test: a file of tests/, or a function of one, perhaps with parameters."""
    file, _, rest = test.partition("::")
    path = TESTS / file
    return not path.is_file() or (rest != "" and f"def {rest.partition('[')[0]}(" not in path.read_text(encoding="utf-8"))


def test_each_row_makes_one_mistake_in_its_file():
    wrong = []
    for mistake in MISTAKES:
        path = SOURCE / mistake.file
        found = faults(mistake, path.read_text(encoding="utf-8")) if path.is_file() else ["its file is not there"]
        wrong += [f"{mistake.file}: {mistake.why}: {fault}" for fault in found]
    assert not wrong, "\n".join(wrong)


def test_each_row_names_tests_that_there_are():
    assert {test for mistake in MISTAKES for test in mistake.tests if missing(test)} == set()
    assert all(mistake.tests for mistake in MISTAKES)


def test_no_two_rows_are_the_same():
    assert len({(mistake.file, mistake.old, mistake.new) for mistake in MISTAKES}) == len(MISTAKES)


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ("b = 1", "b = 2", "stands 0 times"),
        ("a", "b", "stands 2 times"),
        ("a = 1", "a = (", "is no Python"),
        ("a = 1", "a = 1  # one", "changes no code"),
        ("print(a)", "print(c)", "reads names that the file does not have: c"),
    ],
)
def test_a_row_that_does_not_fit_is_found(old, new, fault):
    (found,) = faults(Mistake("a.py", old, new, ("test_mutations.py",), ""), "a = 1\nprint(a)\n")
    assert fault in found


def test_a_row_that_fits_is_none():
    assert faults(Mistake("a.py", "a = 1", "a = 2", ("test_mutations.py",), ""), "a = 1\n") == []
    assert missing("test_nothing.py")
    assert missing("test_mutations.py::test_nothing")
    assert not missing("test_mutations.py::test_no_two_rows_are_the_same[0]")
