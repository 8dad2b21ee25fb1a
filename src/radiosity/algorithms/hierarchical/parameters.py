"""The parameters of hierarchical radiosity."""

from dataclasses import dataclass

import numpy as np

from ...errors import MethodError
from ...method import schemes

REFINEMENTS = tuple(schemes.REFINEMENTS)
MOST_SIDES = 2000  # radiating sides: scenes with more begin with clusters


@dataclass(frozen=True)
class Hierarchical:
    """The parameters of hierarchical radiosity.

    Attributes:
    epsilon: links whose error exceeds this are refined; a pure number, so that neither units nor the scene's size or
        brightness matter.
        brightness-factor: F B_s A_r over the total emitted power of the scene. error-radiance: the link's error of radiosity
        over the largest emitted radiosity. error-power: that error times A_r, over the total emitted power. See `oracle`.
    refinement: one of `REFINEMENTS`.
    rays: rays of a link, which find its visible share; 0 where there are no obstacles.
    coarsest: the first round's epsilon over ``epsilon``, a power of ``step``: rounds go from there down to ``epsilon``.
    step: the factor of epsilon from round to round.
    tolerance: tolerance of the solution with given links, relative to the largest radiosity of a band.
    seed: the seed of the rays.
    clusters: whether sides near each other are grouped; None: where there are more than `MOST_SIDES` of them.

    Raises:
        MethodError: a value out of its range.
    """

    epsilon: float = 1e-5
    refinement: str = "brightness-factor"
    rays: int = 16
    coarsest: float = 64.0
    step: float = 4.0
    tolerance: float = 1e-8
    seed: int = 0
    clusters: bool | None = None

    def __post_init__(self):
        if self.refinement not in REFINEMENTS:
            raise MethodError(f"refinement '{self.refinement}' does not exist; known are {', '.join(REFINEMENTS)}")
        for name, low, high in (("epsilon", 0.0, np.inf), ("tolerance", 0.0, 1.0)):
            if not low < getattr(self, name) < high:
                raise MethodError(f"{name} is {getattr(self, name)!r}; it must be more than {low:g} and less than {high:g}")
        if self.coarsest < 1 or self.step <= 1:
            raise MethodError(f"coarsest is {self.coarsest!r} and step {self.step!r}; they must be at least 1, and more than 1")
        if self.rays < 0:
            raise MethodError(f"rays of a link are {self.rays!r}; they must be 0 or more")

    def clustered(self, sides: int) -> bool:
        """Return whether a scene of so many radiating sides has clusters."""
        return sides > MOST_SIDES if self.clusters is None else self.clusters

    @property
    def rounds(self) -> tuple[float, ...]:
        """The epsilons of multigridding, from the coarsest to ``epsilon``."""
        count = max(round(np.log(self.coarsest) / np.log(self.step)), 0)
        return tuple(self.epsilon * self.step**k for k in range(count, -1, -1))
