"""What a named algorithm is."""

from dataclasses import dataclass
from typing import Generic, TypeVar

from ..baseline import Baseline
from ..model import Method
from .citations import CITATIONS, Citation

Chosen = TypeVar("Chosen", Method, Baseline)


@dataclass(frozen=True)
class Preset(Generic[Chosen]):
    """A named algorithm: a `Method` or a `Baseline`, and what a user should know of it.

    Attributes:
        method: the choices.
        about: what it is, in a few sentences.
        when: when to take it.
        key: of its citation.
        parameters: options of `Method` or `Baseline` that are its own, each with its meaning.
    """

    method: Chosen
    about: str
    when: str
    key: str
    parameters: tuple[tuple[str, str], ...] = ()

    @property
    def source(self) -> Citation:
        """The publication."""
        return CITATIONS[self.key]

    @property
    def citation(self) -> str:
        """The publication in one line."""
        return self.source.text
