"""The rules of imports: each is a function of a package, which names what breaks it."""

import ast
import sys
from collections import Counter

from import_graph import Package, begin_of, circles, import_calls

FLOORS = (  # a folder, or a file of the package's own folder, imports what is above it in this table, and nothing below
    "errors",
    "pieces",
    "hooks",
    "device",
    "sampling",
    "scene",
    "patches",
    "method",
    "problem",
    "tracing",
    "diagnostics",
    "solution",
    "tally",
    "factors",
    "algorithms",
    "run",
    "image",
    "comparison",  # of two solutions; its pictures take cameras and false colours
    "conversion",  # writers of scene files; GLB is packed as that of solutions
    "exchange",  # heat from counted lines: it runs them, and its pictures take cameras and false colours
    "sensors",  # light at points: they run a solution's scene once more
    "lightmap",  # light at texels: a gather at each, and the files that hold them
    "viewer",  # a page in the browser: it shows cameras and false colours of pictures, sensors, and findings
    "report_page",  # of a solution, for clients: its pictures, sensors and findings
    "lab",
    "cluster",  # many machines: it drives runs, and nothing knows of it but the hook by which `solve` calls it
    "",  # __init__.py of the package: the public names, which what is outside the core may use
    "cli",
    "__main__",
)
TO_COME: set[str] = set()
APART = ("scene.formats",)  # folders within folders that count on their own
MOST = 0.22  # of all lines may be in one folder

KERNELS = (
    "device/",
    "sampling/",
    "tracing/",
    "tally/",
    "factors/",
    "algorithms/",
    "problem/bands.py",
    "problem/lights/",
    "sensors/",
)
PLACES = {"drjit": KERNELS, "mitsuba": ("device/", "scene/formats/mitsuba/", "image/")}
EARLY = {  # packages besides numpy that a file may import when it is imported itself
    "cyclopts": ("cli/",),
    "drjit": KERNELS,
    # classes derive from the package's; where they are used their files are loaded
    "distributed": ("cluster/plugin.py",),
    "pydantic": ("scene/formats/toml/schema", "scene/formats/honeybee/schema.py"),
}
RECORDING = {"while_loop", "syntax", "if_stmt", "switch", "dispatch", "freeze"}
WITH_NUMBERS = ("tracing/", "tally/", "factors/", "algorithms/")  # their kernels take numbers


def floor(module: str) -> int:
    """The row of a module's folder."""
    return FLOORS.index(module.split(".")[0])


OLDER = {"scene.check"}  # names of modules that were public before the floors: they pass on what has moved up, and nothing else


def upward(package: Package) -> set[tuple[str, str]]:
    """Imports of a folder above that of the file, and of folders that no floor is known of."""
    pairs = {(a, b) for a, targets in package.edges.items() for b in targets if a not in OLDER}
    return {(a, b) for a, b in pairs if not {a.split(".")[0], b.split(".")[0]} <= set(FLOORS) or floor(b) > floor(a)}


def mutual(package: Package) -> set[frozenset[str]]:
    """Files that import each other, directly or in a circle."""
    return circles(package.edges)


def shares(package: Package) -> dict[str, float]:
    """Folders with more than their share of all lines."""
    lines = Counter()
    for module, path in package.files.items():
        apart = next((name for name in APART if f"{module}.".startswith(f"{name}.")), module.split(".")[0])
        lines[apart] += len(path.read_text(encoding="utf-8").splitlines())
    return {name: count / lines.total() for name, count in lines.items() if count >= MOST * lines.total()}


def unknown_calls(package: Package) -> set[tuple[str, str]]:
    """Calls of `import_module` whose modules cannot be seen in the source."""
    found = set()
    for module, nodes in package.nodes.items():
        for call in import_calls(nodes):
            ours = begin_of(call).startswith((".", f"{package.name}."))
            others = begin_of(call) or ast.unparse(call.args[0]).endswith(".__module__")  # the module that a class is from
            if not (package.named(module) if ours else others):
                found.add((module, ast.unparse(call)))
    return found


def misplaced(package: Package) -> set[tuple[str, str]]:
    """Imports of Dr.Jit and Mitsuba in other places than theirs."""
    return {
        (module, other)
        for module in package.files
        for other in {imported.name.split(".")[0] for imported in package.imports[module]} & set(PLACES)
        if not package.path(module).startswith(PLACES[other])
    }


def heavy(package: Package) -> set[tuple[str, str]]:
    """Imports of other packages outside the functions that use them."""
    free = set(sys.stdlib_module_names) | {package.name, "numpy"}
    return {
        (module, other)
        for module in package.files
        for other in {imported.name.split(".")[0] for imported in package.imports[module] if imported.early} - free
        if not package.path(module).startswith(EARLY.get(other, ("nowhere",)))
    }


def recording(package: Package) -> set[str]:
    """Files that record loops by Dr.Jit themselves.

    In `device.recorded` uploads within a loop are an error and not the end of the process.
    """
    found = set()
    for module, nodes in package.nodes.items():
        attributes = [node for node in nodes if isinstance(node, ast.Attribute) and node.attr in RECORDING]
        if any(isinstance(node.value, ast.Name) and node.value.id in ("dr", "drjit") for node in attributes):
            found.add(module)
        if any(imported.name.startswith("drjit.") and imported.name[6:] in RECORDING for imported in package.imports[module]):
            found.add(module)
    return found - {"device.recorded"}


def unready(package: Package) -> set[str]:
    """Files with kernels that take numbers by `make`, whose tables are not on the device; `ready` puts them there."""
    made = f"{package.name}.sampling.numbers.make"
    files = {module for module in package.files if made in {imported.name for imported in package.imports[module]}}
    return {module for module in files if package.path(module).startswith(WITH_NUMBERS)}
