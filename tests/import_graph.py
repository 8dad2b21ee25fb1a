"""The imports of a package, read from its source: at module level, within functions, and by names in tables.

A name of ours is dotted and begins below the package: ``scene.model``; the package itself is the empty name.
"""

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

NAMED = re.compile(r"[A-Za-z_][\w.-]*(:\w+)?")  # a module, perhaps with a class of it, as tables name them


@dataclass(frozen=True)
class Import:
    """One import of a file.

    Attributes:
        name: ``numpy.random``, or of ours ``radiosity.scene.model``, with what is taken from it.
        early: it runs when the file is imported, and not within a function.
    """

    name: str
    early: bool


@dataclass(frozen=True)
class Package:
    """A package of Python files.

    Attributes:
        root: its folder, whose name it has.
        name: the name that its own absolute imports begin with.
    """

    root: Path
    name: str = "radiosity"

    @cached_property
    def files(self) -> dict[str, Path]:
        """The file of each module, by our name of it."""
        return {".".join(self._parts(path)): path for path in sorted(self.root.rglob("*.py"))}

    @cached_property
    def nodes(self) -> dict[str, list[ast.AST]]:
        """The nodes of the syntax tree of each module, outer ones before those within."""
        return {name: walked(ast.parse(path.read_text(encoding="utf-8"))) for name, path in self.files.items()}

    def path(self, module: str) -> str:
        """The path of a module below the root, such as ``scene/model.py``."""
        return self.files[module].relative_to(self.root).as_posix()

    @cached_property
    def imports(self) -> dict[str, tuple[Import, ...]]:
        """The import statements of each module, name by name."""
        return {module: tuple(self._imports(module)) for module in self.files}

    def _imports(self, module: str) -> Iterator[Import]:
        nodes, here = self.nodes[module], list(self.files[module].relative_to(self.root).parent.parts)
        late: set[int] = set()
        for node in nodes:
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) and id(node) not in late:
                late |= {id(inner) for inner in walked(node)}
        for node in nodes:
            if isinstance(node, ast.Import):
                found = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                base = [self.name, *here[: len(here) - node.level + 1]] if node.level else []
                found = [".".join([*base, *([node.module] if node.module else []), alias.name]) for alias in node.names]
            else:
                continue
            for name in found:
                yield Import(name, id(node) not in late)

    def named(self, module: str) -> set[str]:
        """Our modules that a module imports by names which are text.

        They are the names of tables, relative to its folder, where it hands such names to `import_module`, and full names such as
        ``"radiosity.cli.solve:solve"`` wherever they stand.
        """
        nodes, here = self.nodes[module], list(self.files[module].relative_to(self.root).parent.parts)
        calls, found = import_calls(nodes), set()
        if any(begin_of(call).startswith(".") for call in calls):
            found.update(*(self._table(node, here) for node in nodes))
        for text in _texts(nodes):
            parts = _name(text)
            if parts[:1] == [self.name]:
                found |= self._modules([parts[1:]])
        for call in calls:
            begin = begin_of(call)
            if begin.startswith(f"{self.name}.") and begin.endswith("."):  # f"radiosity.folder.{...}": any module of the folder
                found |= {name for name in self.files if name.startswith(begin[len(self.name) + 1 :])}
        return found - {module}

    @cached_property
    def edges(self) -> dict[str, set[str]]:
        """The modules of ours that each module imports."""
        result = {}
        for module in self.files:
            names = (imported.name.split(".") for imported in self.imports[module])
            targets = {self._target(parts[1:]) for parts in names if parts[0] == self.name}
            result[module] = (targets | self.named(module)) - {module}
        return result

    def _parts(self, path: Path) -> list[str]:
        parts = list(path.relative_to(self.root).with_suffix("").parts)
        return parts[:-1] if parts[-1] == "__init__" else parts

    def _target(self, parts: list[str]) -> str:
        """The module that an imported name is, or is in."""
        while parts and ".".join(parts) not in self.files:
            parts = parts[:-1]
        return ".".join(parts)

    def _table(self, node: ast.AST, here: list[str]) -> set[str]:
        """Modules below ``here`` that a literal names: a dictionary in its values, or else in its keys."""
        if isinstance(node, ast.Dict):
            rows = (node.values, node.keys)
        elif isinstance(node, ast.Tuple | ast.List | ast.Set):
            rows = (node.elts,)
        else:
            return set()
        found = (self._modules([*here, *_name(text)] for text in _texts(row) if _name(text)) for row in rows)
        return next(filter(None, found), set())

    def _modules(self, names: Iterable[list[str]]) -> set[str]:
        """Of names in parts those that are modules."""
        return {".".join(parts) for parts in names if parts} & set(self.files)


def walked(tree: ast.AST) -> list[ast.AST]:
    """The nodes that `ast.walk` gives of a syntax tree, in its order, in half the time."""
    found = [tree]
    for node in found:
        for field in node._fields:
            value = getattr(node, field, None)
            if isinstance(value, ast.AST):
                found.append(value)
            elif isinstance(value, list):
                found += [inner for inner in value if isinstance(inner, ast.AST)]
    return found


def import_calls(nodes: Iterable[ast.AST]) -> list[ast.Call]:
    """Calls of `import_module` among nodes."""
    calls = [node for node in nodes if isinstance(node, ast.Call)]
    return [call for call in calls if getattr(call.func, "id", getattr(call.func, "attr", "")) == "import_module"]


def circles(edges: dict[str, set[str]]) -> set[frozenset[str]]:
    """Modules that import each other, directly or in a circle of any length: each circle with all that hang together with it."""

    def reached(start: str) -> set[str]:
        found, left = set(), [start]
        while left:
            new = edges.get(left.pop(), set()) - found
            found |= new
            left += new
        return found

    ways = {name: reached(name) for name in edges}
    return {frozenset(other for other in ways[name] if name in ways[other]) for name in edges if name in ways[name]}


def begin_of(call: ast.Call) -> str:
    """What the name that a call imports begins with, as far as it is text."""
    name = call.args[0] if call.args else None
    if isinstance(name, ast.JoinedStr) and name.values:
        name = name.values[0]
    return name.value if isinstance(name, ast.Constant) and isinstance(name.value, str) else ""


def _texts(nodes: Iterable[ast.AST | None]) -> set[str]:
    return {node.value for node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, str)}


def _name(text: str) -> list[str]:
    """The parts of a module's name; none of any other text. Names of choices have hyphens where modules have underscores."""
    return text.split(":")[0].replace("-", "_").split(".") if NAMED.fullmatch(text) else []
