"""Sensors that a scene's file asks for; light does not depend on them."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class SensorRequest:
    """One set of sensors: a grid in front of a surface, or points.

    Attributes:
        name: of the set.
        kind: "plane" or "cylindrical".
        surface: name or pattern of the grid's surface; None where there are points.
        height, spacing, margin: of a grid, m; spacing None: by EN 12464-1.
        direction: in which the sensors of a grid look, or their axis; None: along the surface's normal.
        points, normals: m, and the direction of each, one to one; empty for a grid.
    """

    name: str
    kind: str = "plane"
    surface: str | None = None
    height: float = 0.0
    spacing: float | None = None
    margin: float = 0.0
    direction: tuple[float, float, float] | None = None
    points: tuple[tuple[float, float, float], ...] = ()
    normals: tuple[tuple[float, float, float], ...] = ()

    def facts(self) -> dict:
        """Return the request as text of files can hold it."""
        return asdict(self)

    @staticmethod
    def of(facts: dict) -> "SensorRequest":
        """Make the request that `facts` gave.

        Raises:
            KeyError, TypeError, ValueError: something else is in their place.
        """
        known: dict[str, Any] = {key: tuple(_three(row) for row in facts[key]) for key in ("points", "normals")}
        known |= {key: float(facts[key]) for key in ("height", "margin")}
        known["spacing"] = None if facts["spacing"] is None else float(facts["spacing"])
        known["direction"] = None if facts["direction"] is None else _three(facts["direction"])
        words = [facts[key] for key in ("name", "kind")] + ([] if facts["surface"] is None else [facts["surface"]])
        if not all(isinstance(word, str) for word in words):
            raise ValueError("sensors have words in their name, kind and surface")
        return SensorRequest(**facts | known)


def _three(row) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in row)
    return x, y, z
