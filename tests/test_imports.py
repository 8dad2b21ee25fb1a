"""Who may import whom: the walk goes one way, and importing the package stays light."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import radiosity

ROOT = Path(radiosity.__file__).parent
MODULES = sorted(ROOT.rglob("*.py"))
OUTSIDE = {"cli", "view", "cluster"}
EARLY = {"engine", "method", "patches", "scene"}  # what comes before the image on the walk
DRJIT = ("engine/", "method/", "llvm.py")  # llvm.py: only what another package has imported already
MITSUBA = ("engine/", "scene/formats/mitsuba_xml.py", "image/")

CLASSES = {"scene/formats/toml_schema.py": {"pydantic"}}  # its classes derive from the package's; loaded by its reader alone


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def imports(path: Path):
    """(dotted module, at module level?) for each import; our own are relative to the package: ``scene.model``."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    here = list(path.relative_to(ROOT).parent.parts)
    lazy = {id(node) for function in ast.walk(tree) if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
            for node in ast.walk(function)}  # fmt: skip
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            module = node.module or ""
            if node.level:
                base = here[: len(here) - node.level + 1]
                module = ".".join(["radiosity", *base, *([module] if module else [])])
            found = [f"{module}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in found:
            yield name, id(node) not in lazy


def folders_imported(path: Path) -> set[str]:
    parts = (name.split(".") for name, _ in imports(path))
    return {p[1] for p in parts if p[0] == "radiosity" and len(p) > 1}


def test_there_is_something_to_look_at():
    assert len(MODULES) > 15
    assert folders_imported(ROOT / "patches" / "subdivide.py") == {"errors", "scene", "patches"}


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_core_does_not_import_what_is_outside_it(path):
    if name_of(path).split("/")[0] not in OUTSIDE | {"__main__.py"}:
        assert not folders_imported(path) & OUTSIDE


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_nothing_before_the_image_imports_it(path):
    if name_of(path).split("/")[0] in EARLY:
        assert "image" not in folders_imported(path)


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_drjit_and_mitsuba_stay_where_they_belong(path):
    used = {name.split(".")[0] for name, _ in imports(path)}
    if not name_of(path).startswith(DRJIT):
        assert "drjit" not in used
    if not name_of(path).startswith(MITSUBA):
        assert "mitsuba" not in used


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_other_packages_are_imported_where_they_are_used(path):
    allowed = set(sys.stdlib_module_names) | {"radiosity", "numpy"}
    folder = name_of(path)
    if folder.startswith(("engine/", "method/")):
        allowed |= {"drjit", "mitsuba"}
    if folder.startswith("cli/"):
        allowed |= {"cyclopts"}
    allowed |= CLASSES.get(folder, set())
    assert {name.split(".")[0] for name, top in imports(path) if top} <= allowed


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
