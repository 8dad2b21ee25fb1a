"""``auto``: the method is chosen for each scene when it is solved."""

from dataclasses import dataclass

from ..errors import MethodError
from .basis import BASES

NAME = "auto"
ABOUT = (
    "auto, the default, chooses gather, random-walk or a control variate for each scene, by a pilot of a few lines; "
    "with a basis particle-tracing in place of random-walk; the report says which and why (docs/choosing.md)"
)
FALLBACK = "random-walk"  # what choices on the axes are put into


@dataclass(frozen=True)
class Auto:
    """Stands for the method that `solve` chooses: see `run.choice`.

    Attributes:
        basis: of the light on patches, which the chosen method has.

    Raises:
        MethodError: there is no such basis.
    """

    basis: str = "constant"

    machine = NAME
    needs_powers_of_two = False

    def __post_init__(self):
        if self.basis not in BASES:
            raise MethodError(f"basis '{self.basis}' does not exist; known are {', '.join(BASES)}")

    def __str__(self) -> str:
        return NAME if self.basis == "constant" else f"{NAME}/{self.basis}"
