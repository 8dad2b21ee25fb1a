"""The importance of lights without area, by what their lines hit first.

Light of power P that arrives on patch j is worth P (w_j + rho_j K_j), with w and K as in `adjoint`. A light's lines bring to the
result a sum of such terms; its variance is least for a given number of lines where each light fires in proportion to its power
and to the root of the mean square of w + rho K over its lines. That is its importance. Lines that miss the scene count as 0.

A pilot of few lines may find nothing, though some of a light's lines matter. So each light has a part of the lines that its power
asks for, whatever was found: then none of its lines carries more than so many energy packets.
"""

from dataclasses import dataclass

import numpy as np

from ...device.backend import upload
from ...method import Method
from ...problem.model import Problem
from ...sampling.streams import Seed
from ...tally.shooter import Shooter
from ...tracing.geometry import Geometry

LINES = 1 << 15  # of a light, at most
IN_ALL = 1 << 17  # of all lights, about
FEWEST = 64  # of a light
LEAST = 0.01  # of the lines that a light's power asks for: it has these in any case


@dataclass(frozen=True, eq=False)
class FirstHits:
    """What the first lines of lights hit.

    Attributes:
        light, patch: (m,) int64, the light of each line that hit a patch, and this patch.
        each: lines of each light.
        power: (n_lights,) float64, W or lm that each light sends.
    """

    light: np.ndarray
    patch: np.ndarray
    each: int
    power: np.ndarray

    @staticmethod
    def of(geometry: Geometry, problem: Problem, method: Method, seed: Seed) -> "FirstHits":
        """Trace lines of all lights without area; there may be none.

        Args:
            problem: a scalar one.
            method: the numbers of lines, and their randomisation.
        """
        n, lights = problem.rows.n_patches, problem.rows.n_lights
        power = problem.rows.emission[n:, 0]
        none = np.zeros(0, np.int64)
        if not lights:
            return FirstHits(none, none, 0, power)
        each = int(np.clip(IN_ALL // lights, FEWEST, LINES))
        shooter = Shooter(geometry, method, seed, 1, 0, lights=problem.lights)
        counts = np.where(np.arange(n + lights) < n, 0, each).astype(np.uint32)
        found: list[tuple[np.ndarray, np.ndarray]] = []
        shooter.shoot(upload(shooter.types.UInt32, counts), pairs=lambda rows, slots: found.append((rows.copy(), slots.copy())))
        rows, slots = (np.concatenate(column).astype(np.int64) for column in zip(*found, strict=True))
        hit = slots < n
        return FirstHits(rows[hit] - n, slots[hit], each, power)

    @property
    def lines(self) -> int:
        """The number of lines that were traced."""
        return self.each * len(self.power)

    def means(self, worth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the mean of what lines are worth, and the root of the mean of its square, (n_lights,) float64 each.

        Args:
            worth: (n_patches,) of a unit of light that arrives on each patch.
        """
        count = len(self.power)
        sums = [np.bincount(self.light, worth[self.patch] ** power, count) / max(self.each, 1) for power in (1, 2)]
        return sums[0], np.sqrt(sums[1])
