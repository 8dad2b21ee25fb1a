"""``auto``: the method is chosen for each scene when it is solved."""

from dataclasses import dataclass

NAME = "auto"
ABOUT = (
    "auto, the default, chooses gather, random-walk or a control variate for each scene, by a pilot of a few lines; "
    "the report says which and why (docs/choosing.md)"
)
FALLBACK = "random-walk"  # what choices on the axes are put into


@dataclass(frozen=True)
class Auto:
    """Stands for the method that `solve` chooses: see `run.choice`."""

    machine = NAME
    needs_powers_of_two = False

    def __str__(self) -> str:
        return NAME
