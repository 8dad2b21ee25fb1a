"""Who may import whom: the walk goes one way, and importing the package stays light."""

import ast
import subprocess
import sys
from pathlib import Path

import radiosity

ROOT = Path(radiosity.__file__).parent
MODULES = sorted(ROOT.rglob("*.py"))
OUTSIDE = {"cli", "view", "cluster"}
EARLY = {"engine", "method", "patches", "scene"}  # what comes before the image on the walk
PLACES = {
    "drjit": ("engine/", "method/", "llvm.py"),  # llvm.py: only what another package has imported already
    "mitsuba": ("engine/", "scene/formats/mitsuba/", "image/"),
}
CLASSES = {"scene/formats/toml/schema.py": {"pydantic"}}  # its classes derive from the package's; loaded by its reader alone


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def imports(path: Path):
    """(dotted module, at module level?) for each import; our own are relative to the package: ``scene.model``."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    here = list(path.relative_to(ROOT).parent.parts)
    lazy = {
        id(node)
        for function in ast.walk(tree)
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        for node in ast.walk(function)
    }
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


def offenders(rule) -> dict[str, set[str]]:
    """What each module imports against a rule; ``rule(name, path)`` is the set of offending names of one."""
    found = {name_of(path): rule(name_of(path), path) for path in MODULES}
    return {name: wrong for name, wrong in found.items() if wrong}


def test_core_does_not_import_what_is_outside_it():
    def rule(name, path):
        return set() if name.split("/")[0] in OUTSIDE | {"__main__.py"} else folders_imported(path) & OUTSIDE

    assert offenders(rule) == {}


def test_nothing_before_the_image_imports_it():
    def rule(name, path):
        return folders_imported(path) & {"image"} if name.split("/")[0] in EARLY else set()

    assert offenders(rule) == {}


def test_drjit_and_mitsuba_stay_where_they_belong():
    def rule(name, path):
        used = {imported.split(".")[0] for imported, _ in imports(path)}
        allowed = {package for package, places in PLACES.items() if name.startswith(places)}
        return used & (set(PLACES) - allowed)

    assert offenders(rule) == {}


def test_other_packages_are_imported_where_they_are_used():
    def rule(name, path):
        allowed = set(sys.stdlib_module_names) | {"radiosity", "numpy"} | CLASSES.get(name, set())
        if name.startswith(("engine/", "method/")):
            allowed |= {"drjit", "mitsuba"}
        if name.startswith("cli/"):
            allowed |= {"cyclopts"}
        return {imported.split(".")[0] for imported, top in imports(path) if top} - allowed

    assert offenders(rule) == {}


def called(path: Path) -> set[str]:
    """Names that a module uses of Dr.Jit, such as ``eval`` of ``dr.eval``."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    attributes = (node for node in ast.walk(tree) if isinstance(node, ast.Attribute))
    return {node.attr for node in attributes if isinstance(node.value, ast.Name) and node.value.id == "dr"}


def test_loops_are_recorded_in_one_place():
    """`device.recorded`, where uploads within them are an error and not the end of the process."""
    recording = {"while_loop", "syntax", "if_stmt", "switch", "dispatch", "freeze"}

    def rule(name, path):
        return set() if name == "device/recorded.py" else called(path) & recording

    assert offenders(rule) == {}
    assert called(ROOT / "engine" / "recorded.py") >= {"while_loop"}


def test_kernels_take_numbers_whose_tables_are_on_the_device():
    """`ready`, not `make`."""

    def rule(name, path):
        found = {imported for imported, _ in imports(path)} & {"radiosity.sampling.numbers.make"}
        return found if name.startswith(("engine/", "deterministic/")) else set()

    assert offenders(rule) == {}
    assert "radiosity.sampling.numbers.ready" in {imported for imported, _ in imports(ROOT / "engine" / "firing.py")}


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
