"""The tree of plain values that a Mitsuba scene file is read into."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ....errors import SceneError


@dataclass(frozen=True)
class Spectrum:
    """Values at wavelengths (nm), or one value for all."""

    wavelengths: tuple[float, ...]
    values: tuple[float, ...]


@dataclass(eq=False)
class Node:
    """A plugin in the file.

    Attributes:
        kind: Scene, Shape, BSDF, Emitter, Sensor, Film, Texture, ...
        plugin: its type, such as ``diffuse``.
        name: the id, or the name it has in its parent, or "".
        place: file, line and column.
        values: numbers, strings, booleans, colours as (3,) arrays, `Spectrum`, transformations as (4, 4) arrays.
        children: nested and referenced plugins, with the names of the arguments.
    """

    kind: str
    plugin: str
    name: str
    place: str
    values: dict[str, Any] = field(default_factory=dict)
    children: list[tuple[str, "Node"]] = field(default_factory=list)

    def of(self, kind: str) -> list["Node"]:
        """The children of a kind."""
        return [child for _, child in self.children if child.kind == kind]

    def number(self, name: str, default: float) -> float:
        """A numeric argument.

        Raises:
            SceneError: it is something else.
        """
        value = self.values.get(name, default)
        if not isinstance(value, int | float):
            raise SceneError(f"{self.place}: '{name}' of this '{self.plugin}' is {value!r}; expected a number")
        return value

    def vector(self, name: str, default: tuple[float, float, float]) -> np.ndarray:
        """Return an argument that is a point or vector, (3,).

        Raises:
            SceneError: the argument is something else.
        """
        value = self.values.get(name, default)
        if np.shape(value) != (3,):
            raise SceneError(f"{self.place}: '{name}' of this '{self.plugin}' is {value!r}; expected three numbers")
        return np.asarray(value, np.float64)

    def child(self, name: str) -> "Node | None":
        """The child that is the argument ``name``."""
        return next((child for key, child in self.children if key == name), None)
