"""Who traces the lines of a year: this process, or others, which get units of them."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from ...hooks import HOOKS
from ...problem.model import Problem
from .coefficients import Replicate, Setup
from .gathering import Caught, Range

Shares = tuple[np.ndarray, np.ndarray]  # see `Replicate.suns`


@dataclass(frozen=True, eq=False)
class SkyUnit:
    """Lines of the patches or sensors of a replicate.

    Attributes:
        replicate: its number.
        patches: whether they are those of patches.
        ranges: of cosine lines and shadow rays, of each receiver.
        lines: their number in all.
    """

    replicate: int
    patches: bool
    ranges: tuple[Range, Range]
    lines: int

    def traced(self, run: Replicate) -> Caught:
        """Return what the lines bring."""
        return run.of(patches=self.patches).caught(self.ranges)

    def cut(self, parts: int) -> "list[SkyUnit]":
        """Return units that have some of the lines of each receiver each; the lines of all are those of this one."""
        ends = [tuple(low + (high - low) * at // parts for low, high in self.ranges) for at in range(parts + 1)]
        given = self.replicate, self.patches
        return [SkyUnit(*given, ((a, c), (b, d)), self.lines // parts) for (a, b), (c, d) in pairwise(ends)]


@dataclass(frozen=True, eq=False)
class SunUnit:
    """Rays to suns of the patches or sensors of a replicate.

    Attributes:
        replicate, patches: as of `SkyUnit`.
        towards, first: all suns, see `Sunlight.shares`.
        begin, end: the suns of this unit.
        lines: the number of rays.
        places: of the patches that are asked.
    """

    replicate: int
    patches: bool
    towards: np.ndarray
    first: int
    begin: int
    end: int
    lines: int
    places: np.ndarray | None = None

    def traced(self, run: Replicate) -> np.ndarray:
        """Return what the rays bring, (n_suns, n_places) float32."""
        rays = run.sunlight(patches=self.patches, places=self.places)
        return rays.shares(self.towards, self.first, slice(self.begin, self.end))

    def cut(self, parts: int) -> "list[SunUnit]":
        """Return units that have some of the suns each."""
        ends = np.linspace(self.begin, self.end, parts + 1).astype(int).tolist()
        given = self.replicate, self.patches, self.towards, self.first
        return [SunUnit(*given, low, high, self.lines // parts, self.places) for low, high in pairwise(ends)]


class AbstractYearLines(ABC):
    """Traces the lines of the replicates of a year."""

    @abstractmethod
    def advance(self, runs: list[Replicate], each: int) -> Iterator[int]:
        """Trace until each sensor of each replicate has so many lines of both kinds; yield numbers of new lines."""

    @abstractmethod
    def suns(self, runs: list[Replicate], towards: np.ndarray, first: int) -> Iterator[Shares]:
        """Yield `Replicate.suns` of each replicate."""


class HereLines(AbstractYearLines):
    """Traces all lines here."""

    def advance(self, runs: list[Replicate], each: int) -> Iterator[int]:
        return (run.advance(each) for run in runs)

    def suns(self, runs: list[Replicate], towards: np.ndarray, first: int) -> Iterator[Shares]:
        return (run.suns(towards, first) for run in runs)


def tracing_on(client: Any, setup: Setup, problem: Problem, device: str) -> AbstractContextManager[AbstractYearLines]:
    """Return a context that gives what traces lines: the workers of a client, or this process where it is None."""
    return nullcontext(HereLines()) if client is None else HOOKS["years"](client, setup, problem, device)
