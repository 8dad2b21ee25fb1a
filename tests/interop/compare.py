"""Differences between two readings of a file, and which of them are explained."""

from dataclasses import dataclass, field

import numpy as np

from .explained import EXPLAINED, Explained
from .record import Reading, Surface

SINGLE = 2e-5  # relative: most readers hold single precision
COLOR = 5e-4  # tables of sRGB, and half precision in some
SAMPLED = 1e-2  # means over points of a texture


@dataclass(frozen=True)
class Difference:
    """One quantity of one surface that two readers see differently."""

    surface: str
    quantity: str
    ours: object
    theirs: object

    def __str__(self) -> str:
        return f"{self.quantity} of '{self.surface}': we read {_text(self.ours)}, the other reads {_text(self.theirs)}"


@dataclass
class Outcome:
    """Of many files and one other reader.

    Attributes:
        files: how many were compared.
        alike: how many showed no difference at all.
        features: all that were drawn.
        used: files that each explanation was needed for.
        faults: differences that nothing explains, each with its file.
    """

    files: int = 0
    alike: int = 0
    features: set[str] = field(default_factory=set)
    used: dict[Explained, int] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)

    def add(self, sample, reader: str, found: list[Difference]) -> None:
        self.files += 1
        self.features |= sample.features
        self.alike += not found
        needed = set()
        for one in found:
            why = next((e for e in EXPLAINED if e.covers(sample, reader, one.quantity)), None)
            if why is None:
                self.faults.append(f"{sample.path.name} ({', '.join(sorted(sample.features))}), {reader}: {one}")
            else:
                needed.add(why)
        for why in needed:
            self.used[why] = self.used.get(why, 0) + 1


def differences(mine: Reading, theirs: Reading) -> list[Difference]:
    """All quantities that both readers know and that differ by more than rounding."""
    found = []
    if set(mine) != set(theirs):
        found.append(Difference("*", "names", sorted(set(mine) - set(theirs)), sorted(set(theirs) - set(mine))))
    for name in sorted(set(mine) & set(theirs)):
        one, two = mine[name], theirs[name]
        for quantity, bound in _bounds(one, two).items():
            a, b = getattr(one, quantity), getattr(two, quantity)
            if a is not None and b is not None and not (np.abs(np.subtract(a, b)) <= bound).all():
                found.append(Difference(name, quantity, a, b))
    return found


def _bounds(one: Surface, two: Surface) -> dict[str, float]:
    """Largest difference of each quantity that is rounding."""
    size = float(np.abs([one.bounds, two.bounds]).max())
    area = max(one.area, two.area)
    sampled = one.sampled or two.sampled
    power = 0.0 if one.power is None or two.power is None else float(np.abs([one.power, two.power]).max())
    # a thin triangle far from the origin: its edges are rounded by the size of its coordinates
    slack = SINGLE * (area + size * np.sqrt(area))
    return {
        "area": slack,
        "vector": slack,
        "volume": slack * size,
        "bounds": SINGLE * size,
        "sides": 0,
        "reflectance": SAMPLED if sampled else COLOR,
        "power": (SAMPLED if sampled else COLOR) * power,
    }


def _text(value) -> str:
    return np.array2string(np.asarray(value), precision=6) if not isinstance(value, list) else str(value)
