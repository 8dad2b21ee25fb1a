"""Options of methods: the name, the values and the meaning of each, stated once for every place that needs them."""

import inspect
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeVar

from ..errors import MethodError

Kind = Literal["choice", "switch", "flag", "whole", "share"]
Described = TypeVar("Described")
WIDTH = 120


@dataclass(frozen=True)
class Option:
    """One option of `Method` or `Baseline`, which have a field of its name. The default is that of the field.

    Attributes:
        name: the name of the field; on the command line with hyphens.
        about: what it means, as ``radiosity solve --help`` says it.
        kind: what it takes. A "choice" takes a named value, a "switch" True or False, a "flag" too, but no option of the
            command line turns it off; "whole" is a whole number, a "share" a number between 0 and 1.
        values: the values of a choice, each with its meaning; of a flag, what it takes in Python besides True and False.
        most: the largest whole number; the smallest is 1.
        zero: whether the share may be 0.
        share_of: what it is a share of, where it may be 0.
        optional: whether the value may be None.
        schemes: schemes of `Baseline` that use the option.
        tuning: whether it changes only the speed; it is then shown with the options of the run.
        details: more text for the reference.
    """

    name: str
    about: str
    kind: Kind = "choice"
    values: Mapping[str, str] = field(default_factory=dict)
    most: int = 0
    zero: bool = False
    share_of: str = "all lines"
    optional: bool = False
    schemes: tuple[str, ...] = ()
    tuning: bool = False
    details: str = ""

    def check(self, value) -> None:
        """Refuse a value that the option does not take.

        Raises:
            MethodError: the value, and what is taken.
        """
        if self.optional and value is None:
            return
        if self.kind == "choice" and value not in tuple(self.values):
            raise MethodError(f"{self.name} '{value}' does not exist; known are {', '.join(self.values)}")
        if self.kind in ("switch", "flag") and not isinstance(value, bool) and value not in tuple(self.values):
            others = "".join(f", or '{other}'" for other in self.values)
            raise MethodError(f"{self.name} is {value!r}; it must be True or False{others}")
        if self.kind == "whole" and not (_is(int, value) and 1 <= value <= self.most):
            raise MethodError(f"{self.name} is {value!r}; it must be a whole number from 1 to {self.most}")
        if self.kind == "share" and not (_is(int | float, value) and (0 < value < 1 or (self.zero and value == 0))):
            taken = f"it is the share of {self.share_of}, a number at least 0" if self.zero else "it must be a number above 0"
            raise MethodError(f"{self.name} is {value!r}; {taken} and below 1")

    @property
    def entry(self) -> str:
        """The line about the option in a docstring."""
        return f"{self.name}: {' '.join(filter(None, (self.about, self.details)))}".replace("`", "``")


def _is(kind, value) -> bool:
    return isinstance(value, kind) and not isinstance(value, bool)


def table(*options: Option) -> dict[str, Option]:
    """Return the options by their names."""
    return {option.name: option for option in options}


def documented(options: Mapping[str, Option]) -> Callable[[type[Described]], type[Described]]:
    """Put what each option means into the docstring of a class, as its attributes."""

    def change(cls: type[Described]) -> type[Described]:
        if cls.__doc__:  # python -OO leaves none
            first, *rest = inspect.cleandoc(cls.__doc__).split("\n\n", 1)
            entries = (
                textwrap.fill(option.entry, WIDTH, subsequent_indent="    ", break_on_hyphens=False)
                for option in options.values()
            )
            attributes = "Attributes:\n" + textwrap.indent("\n".join(entries), "    ")
            cls.__doc__ = "\n\n".join([first, attributes, *rest])
        return cls

    return change
