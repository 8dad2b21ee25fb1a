"""Who may import whom: folders stand on floors, no files import each other, and importing the package stays light."""

import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
from import_graph import Package, begin_of, import_calls
from import_rules import APART, FLOORS, TO_COME, heavy, misplaced, mutual, recording, shares, unknown_calls, unready, upward

import radiosity


@pytest.fixture(scope="module")
def ours():
    return Package(Path(radiosity.__file__).parent)


def test_folders_import_those_below_them_only(ours):
    assert upward(ours) == set()


def test_no_files_import_each_other(ours):
    assert mutual(ours) == set()


def test_no_folder_is_too_large(ours):
    assert shares(ours) == {}


@pytest.mark.parametrize("rule", [unknown_calls, misplaced, heavy, recording, unready])
def test_imports_are_where_they_belong(ours, rule):
    assert rule(ours) == set()


def test_every_floor_is_there_and_every_folder_has_one(ours):
    assert {module.split(".")[0] for module in ours.files} == set(FLOORS) - TO_COME
    assert set(APART) <= set(ours.files)
    assert len(FLOORS) == len(set(FLOORS))


TABLES = {  # modules that are imported by name: a table of their names and, where they stand in its keys, a word about it
    "": ("_HOMES", "keys"),
    "algorithms.firing.orders": ("FIRED", "values"),
    "algorithms.table": ("ALGORITHMS", "values"),
    "conversion.save": ("SUFFIXES", "values"),
    "factors.solvers": ("SOLVERS", "values"),
    "factors.sources": ("ROWS", "values"),
    "image": ("FORMATS", "values"),
    "lab.experiments": ("EXPERIMENTS", "values"),
    "sampling.numbers": ("NUMBERS", "values"),
    "scene.formats": ("FORMATS", "values"),
}


@pytest.mark.parametrize("module", TABLES)
def test_modules_that_tables_name_are_imports(ours, module):
    table, part = TABLES[module]
    names = getattr(getattr(import_module(f"radiosity.{module}".rstrip(".")), table), part)()
    folder = module if ours.path(module).endswith("__init__.py") else module.rpartition(".")[0]
    found = {f"{folder}.{name.split(':')[0].replace('-', '_')}".lstrip(".") for name in names}
    assert ours.edges[module] >= found
    assert ours.named(module) >= found
    assert len(found) > 2


def test_there_are_no_other_tables(ours):
    calling = {module for module, nodes in ours.nodes.items() if any(begin_of(c).startswith(".") for c in import_calls(nodes))}
    assert calling == set(TABLES)


def test_imports_of_a_file_are_found(ours):
    assert ours.edges["patches.subdivide"] == {"errors", "hooks", "pieces", "scene.model", "patches.cells", "patches.model"}
    assert "image" in ours.edges[""]  # within a function
    assert {"sampling.numbers.sobol", "sampling.numbers.random"} <= ours.edges["cli.methods"]  # by the beginning of their names
    assert recording(Package(ours.root / "device")) == {"recorded"}


def loaded_by(statement: str) -> set[str]:
    code = f"{statement}\nimport sys\nprint(*sorted({{name.split('.')[0] for name in sys.modules}}))"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(run.stdout.split())


HEAVY = {"drjit", "mitsuba", "scipy", "matplotlib", "trimesh", "pyradiance", "pydantic", "PIL", "rich", "cyclopts"}


def test_importing_the_package_is_light():
    assert not loaded_by("import radiosity") & HEAVY


def test_asking_for_help_is_light():
    loaded = loaded_by("from radiosity.cli.app import app")
    assert "cyclopts" in loaded
    assert not loaded & (HEAVY - {"cyclopts", "rich"})
