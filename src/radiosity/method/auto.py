"""``auto``: the method is chosen for each scene when it is solved."""

from dataclasses import dataclass

NAME = "auto"
FALLBACK = "random-walk"  # what choices on the axes are put into


@dataclass(frozen=True)
class Auto:
    """Stands for the method that `solve` chooses: see `run.choice`."""

    machine = NAME
    needs_powers_of_two = False

    def __str__(self) -> str:
        return NAME
