"""Each rule of imports finds what breaks it, in small packages that do."""

from pathlib import Path

import pytest
from import_graph import Package
from import_rules import heavy, misplaced, mutual, recording, shares, unknown_calls, unready, upward


def package_of(folder: Path, files: dict[str, str]) -> Package:
    for path, text in files.items():
        place = folder / "radiosity" / path
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text)
    return Package(folder / "radiosity")


BY_NAME = "from importlib import import_module\nTABLE = {'a': 'model:Solution'}\nimport_module(f'.{TABLE[name]}', __package__)\n"
MODELS = {"scene/__init__.py": "", "scene/model.py": "", "solution/__init__.py": "", "solution/model.py": ""}
WRONG = {
    "up": (upward, {"scene/a.py": "from ..solution.model import Solution"}, {("scene.a", "solution.model")}),
    "up, absolutely": (upward, {"scene/a.py": "import radiosity.solution.model"}, {("scene.a", "solution.model")}),
    "up, late": (upward, {"scene/a.py": "def f():\n    from ..solution import model"}, {("scene.a", "solution.model")}),
    "up, for types": (
        upward,
        {"scene/a.py": "if TYPE_CHECKING:\n    from ..solution.model import Solution"},
        {("scene.a", "solution.model")},
    ),
    "up, by text": (upward, {"scene/a.py": "at = 'radiosity.solution.model:Solution'"}, {("scene.a", "solution.model")}),
    "up, by a prefix": (
        upward,
        {"scene/a.py": "import_module(f'radiosity.solution.{name}')"},
        {("scene.a", "solution.model")},
    ),
    "up, to the package": (upward, {"scene/a.py": "from .. import solve", "__init__.py": ""}, {("scene.a", "")}),
    "no floor": (upward, {"attic/a.py": "from ..scene import model"}, {("attic.a", "scene.model")}),
    "two": (
        mutual,
        {"scene/a.py": "from . import b", "scene/b.py": "def f():\n    from .a import x"},
        {frozenset({"scene.a", "scene.b"})},
    ),
    "three": (
        mutual,
        {"scene/a.py": "from . import b", "scene/b.py": "from . import c", "scene/c.py": "from .a import x"},
        {frozenset({"scene.a", "scene.b", "scene.c"})},
    ),
    "by a table": (
        mutual,
        {"solution/__init__.py": BY_NAME, "solution/model.py": "from . import load_solution"},
        {frozenset({"solution", "solution.model"})},
    ),
    "by a table's keys": (
        mutual,
        {
            "solution/__init__.py": BY_NAME.replace("'a': 'model:Solution'", "'model': 'text'"),
            "solution/model.py": "from . import x",
        },
        {frozenset({"solution", "solution.model"})},
    ),
    "a call that hides its module": (unknown_calls, {"scene/a.py": "import_module(name)"}, {("scene.a", "import_module(name)")}),
    "a call without a table": (
        unknown_calls,
        {"scene/a.py": "import_module(f'.{name}', __package__)"},
        {("scene.a", "import_module(f'.{name}', __package__)")},
    ),
    "drjit": (misplaced, {"solution/a.py": "def f():\n    import drjit as dr"}, {("solution.a", "drjit")}),
    "mitsuba": (misplaced, {"tracing/a.py": "from mitsuba import Bitmap"}, {("tracing.a", "mitsuba")}),
    "scipy": (heavy, {"solution/a.py": "from scipy.stats import t"}, {("solution.a", "scipy")}),
    "cyclopts": (heavy, {"solution/a.py": "import cyclopts"}, {("solution.a", "cyclopts")}),
    "a loop": (recording, {"tracing/a.py": "dr.while_loop(state, going, body)"}, {"tracing.a"}),
    "a loop's function": (recording, {"tracing/a.py": "from drjit import while_loop"}, {"tracing.a"}),
    "make": (unready, {"tracing/a.py": "from ..sampling.numbers import make", "sampling/numbers.py": ""}, {"tracing.a"}),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_breaks_a_rule_is_found(tmp_path, case):
    rule, files, found = WRONG[case]
    assert rule(package_of(tmp_path, MODELS)) == set()
    assert rule(package_of(tmp_path, files)) == found


def test_a_folder_that_is_too_large_is_found(tmp_path):
    files = {f"{name}/a.py": "\n" * 19 for name in ("device", "sampling", "patches", "method", "run")}
    package = package_of(tmp_path, files | {"scene/a.py": "\n" * 15, "scene/formats/a.py": "\n" * 40})
    assert shares(package) == {"scene.formats": 40 / 150}
