"""What a named algorithm is."""

from dataclasses import dataclass, replace
from typing import Generic, TypeVar

from ...errors import MethodError
from ..baseline import Baseline
from ..model import Method
from ..option import Option
from ..options import BASELINE, METHOD
from .citations import CITATIONS, Citation

Chosen = TypeVar("Chosen", Method, Baseline)


@dataclass(frozen=True)
class Preset(Generic[Chosen]):
    """A named algorithm: a `Method` or a `Baseline`, and what a user should know about it.

    Attributes:
        method: the choices.
        about: what it is, in a few sentences.
        when: when to take it.
        key: the key of its citation.
        own: names of the options that concern it in particular, besides the four axes.
    """

    method: Chosen
    about: str
    when: str
    key: str
    own: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """The options that concern it, each with its meaning and the values that go with the other choices of the method."""
        return tuple((name, self._meaning((METHOD | BASELINE)[name])) for name in self.own)

    def _meaning(self, option: Option) -> str:
        taken = [value for value in option.values if self._takes(option.name, value)]
        return option.about if len(taken) == len(option.values) else f"{option.about} Here: {', '.join(taken)}."

    def _takes(self, name: str, value: str) -> bool:
        try:
            replace(self.method, **{name: value})
        except MethodError:
            return False
        return True

    @property
    def source(self) -> Citation:
        """The publication."""
        return CITATIONS[self.key]

    @property
    def citation(self) -> str:
        """The publication in one line."""
        return self.source.text
