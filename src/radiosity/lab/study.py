"""The parts of an experiment: arms, scenes, and how far it goes."""

from dataclasses import dataclass, replace

import numpy as np

from ..method import Method
from ..patches.model import Patches

FIRST = 10  # the ladder of lines begins at 2^10


@dataclass(frozen=True)
class Arm:
    """An arm: a method whose error is a curve of a figure.

    Attributes:
        name: in the legend, such as "random walk, Halton".
        method: the method that is run.
        family: arms of one family share a colour; ``quasi`` ones are drawn solid, those of random numbers dashed.
    """

    name: str
    method: Method
    family: str

    @property
    def quasi(self) -> bool:
        return self.method.numbers != "random"


def with_both_numbers(methods: dict[str, Method]) -> tuple[Arm, ...]:
    """Return two arms for each method, a family of its name: one with random and one with Halton numbers.

    All patches have one shift, as in the paper.
    """
    kinds = {"random": "random", "Halton": "halton"}
    return tuple(
        Arm(f"{name}, {kind}", replace(method, numbers=numbers, randomisation="shared"), name)
        for name, method in methods.items()
        for kind, numbers in kinds.items()
    )


@dataclass(frozen=True, eq=False)
class Case:
    """A scene of an experiment and what its solution is compared with.

    Attributes:
        name: such as "labyrinth-0.5".
        patches: its unknowns are their radiosities.
        exact: (n_patches,) radiosity where it is known, else None: then a reference is computed by the arms' own equation.
    """

    name: str
    patches: Patches
    exact: np.ndarray | None


@dataclass(frozen=True)
class Protocol:
    """How far an experiment goes.

    Attributes:
        last: the ladder of lines of one replicate ends at 2^last.
        replicates: independent randomisations of every arm.
        reference: a reference has this many times the lines of the last rung of all replicates together.
        seed: of all runs.
    """

    last: int = 23
    replicates: int = 5
    reference: int = 100
    seed: int = 1

    @property
    def rungs(self) -> list[int]:
        """The lines of one replicate at each rung, which double."""
        return [1 << k for k in range(FIRST, self.last + 1)]


QUICK = Protocol(last=17)
FULL = Protocol()


@dataclass(frozen=True)
class Claim:
    """A claim of the paper, and whether this run agrees.

    Attributes:
        says: what the paper states.
        agrees: True, False, or None where it is reported only.
        found: what was measured, in a sentence with figures.
    """

    says: str
    agrees: bool | None
    found: str
