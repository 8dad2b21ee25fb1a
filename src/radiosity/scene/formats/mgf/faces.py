"""Faces of a reduced MGF description: objects name them, transformations place and repeat them."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ....errors import SceneError
from .context import MgfMaterial, NamedContexts
from .faults import Faults, Statement, decode
from .transform import instances

MOST_STATEMENTS = 20_000_000  # followed in all, repeats of arrays included
NOWHERE = -1  # transformation of a block that is left out


@dataclass
class Polygons:
    """Faces of one surface and material.

    Attributes:
        corners: vertex numbers, one face after the other.
        sizes: corners of each face.
        transform: number of each face's transformation.
        statement: number of each face's statement.
    """

    corners: list[int] = field(default_factory=list)
    sizes: list[int] = field(default_factory=list)
    transform: list[int] = field(default_factory=list)
    statement: list[int] = field(default_factory=list)


@dataclass
class Block:
    """A transformation in effect: the number of the one around it, its first line, and the instances to come."""

    outer: int
    start: int
    matrices: Iterator[np.ndarray | None]


class FaceReader:
    """Follows a reduced description line by line.

    Attributes:
        contexts: colours, materials, vertices.
        transforms: (4, 4) matrices on row vectors; number 0 is the identity.
        polygons: by surface name and material.
        begun: places where an object of each name begins; those that arrays and includes repeat are one.
    """

    def __init__(self, statements: list[Statement], faults: Faults):
        self._statements, self._faults = statements, faults
        self.contexts = NamedContexts()
        self.transforms: list[np.ndarray] = [np.eye(4)]
        self.polygons: dict[tuple[str, MgfMaterial], Polygons] = {}
        self._current = Polygons()
        self.begun: dict[str, set[str]] = {}
        self._path: list[str] = []
        self._blocks: list[Block] = []
        self._transform = 0
        self._at = 0  # number of the statement that the lines come from
        self._handlers = {**self.contexts.handlers, b"f": self._face, b"o": self._object, b"#": self._mark}

    def follow(self, lines: list[bytes]) -> None:
        """Read all lines.

        Raises:
            SceneError: arrays unfold without bound; a fault and faults are errors.
        """
        at = count = 0
        while at < len(lines):
            words = lines[at].split()
            at += 1
            try:
                if words[0] == b"xf":
                    at = self._xf(words, at)
                else:
                    self._handlers[words[0]](words)
            except SceneError:
                raise
            except KeyError as error:
                self._fault(f"'{decode(error.args[0])}' is not defined")
            except ValueError as error:
                self._fault(f"{error} in '{decode(b' '.join(words))[:60]}'")
            count += 1
            if count > MOST_STATEMENTS:
                place = self._statements[self._at].place
                raise SceneError(f"{place}: the arrays unfold to more than {MOST_STATEMENTS} statements; split the scene")
        if self._blocks:
            self._fault("the file ends inside a transformation (xf)")

    def _fault(self, what: str) -> None:
        self._faults.add(self._statements[self._at].place, what)

    def _mark(self, words) -> None:
        if len(words) == 2:
            self._at = int(words[1])
            self.contexts.file = self._statements[self._at].file

    def _face(self, words) -> None:
        vertices = self.contexts.vertices
        corners = [vertices[name] for name in words[1:]]
        if len(corners) < 3:
            raise ValueError("a face needs three vertices")
        if self._transform == NOWHERE:
            return
        if self.contexts.changed:
            self.contexts.changed = False
            name = "/".join([*([".".join(self._path)] if self._path else []), self.contexts.material_name])
            self._current = self.polygons.setdefault((name, self.contexts.material), Polygons())
        self._current.corners.extend(corners)
        self._current.sizes.append(len(corners))
        self._current.transform.append(self._transform)
        self._current.statement.append(self._at)

    def _object(self, words) -> None:
        self.contexts.changed = True
        if len(words) > 1:
            self._path.append(decode(b" ".join(words[1:])))
            self.begun.setdefault(".".join(self._path), set()).add(self._statements[self._at].place)
        elif self._path:
            self._path.pop()
        else:
            raise ValueError("no object to end")

    def _xf(self, words, at: int) -> int:
        """Begin a transformation, or end it or its present instance; the line to go on with."""
        if len(words) > 1:
            self._blocks.append(Block(self._transform, at, self._matrices(words)))
        elif not self._blocks:
            raise ValueError("no transformation to end")
        block = self._blocks[-1]
        matrix = next(block.matrices, False)
        if matrix is False:
            self._transform = block.outer
            self._blocks.pop()
            return at
        if matrix is None or block.outer == NOWHERE:
            self._transform = NOWHERE
        else:
            self._transform = len(self.transforms)
            self.transforms.append(matrix @ self.transforms[block.outer])  # the inner applies first
        return block.start

    def _matrices(self, words) -> Iterator[np.ndarray | None]:
        try:
            return instances(words[1:])
        except ValueError as error:
            self._fault(f"transformation {error} is not understood and all inside it")
            return iter([None])
