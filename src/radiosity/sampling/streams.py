"""Streams of random numbers: every purpose has a name, and a stream of its own.

The number of a purpose is part of what a seed means: another number would change the bits of all runs that use it.
"""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np


@dataclass(frozen=True)
class Seed:
    """What all random numbers of a run follow from, and which of the seed's replicates the run has.

    A run of R replicates has the replicates ``first_replicate`` to ``first_replicate + R - 1`` of its seed. Within the run they
    are counted from 0 on. So runs of other replicates of one seed are parts of one run of them all.

    Attributes:
        value: a whole number of 0 or more.
        first_replicate: the run's first one.
    """

    value: int
    first_replicate: int = 0

    @staticmethod
    def of(seed: "Seed | int") -> "Seed":
        """A whole number is a seed whose replicates begin with the first."""
        return seed if isinstance(seed, Seed) else Seed(seed)

    def moved(self, by: int) -> "Seed":
        """Another value, the same replicates."""
        return replace(self, value=self.value + by)

    def split(self, parts: int) -> "Seed":
        """Return a seed for streams of parts of replicates: part p of replicate r is counted as r * parts + p."""
        return replace(self, first_replicate=self.first_replicate * parts)

    def number_of(self, replicate: int) -> int:
        """A whole number of 64 bits for a replicate, where a number is all that can be given."""
        return self.value + ((self.first_replicate + replicate) << 32)


class Purpose(IntEnum):
    """The purposes of streams."""

    PHASE = 0  # the rounding offset of each patch
    NUMBERS = 1  # the randomisation of the numbers of lines
    MIXING = 2  # global multipath: the order of spans in a block, which is the key of a child
    LATER_SEGMENTS = 3  # walks: the segments after the first, one child each
    HEMICUBE = 4  # the angle about the normal of each patch
    VISIBILITY = 5  # lines between two polygons
    RESIDUE = 6  # where lines begin that send the residue on
    RESIDUE_LINES = 7  # the numbers of those lines
    SEQUENCE = 8  # iterations: sequences after the first, one child each
    SHADOW_RAYS = 9  # gather: shadow rays
    PILOT = 10  # gather: cosine lines of the pilot
    PILOT_SHADOW = 11  # gather: shadow rays of the pilot
    VIEW_FACTORS = 12  # pairs that tell whether polygons are better than lines
    SENSORS = 13  # cosine lines of sensors
    SENSORS_SHADOW = 14  # shadow rays of sensors
    SENSORS_PILOT = 15  # cosine lines of the pilot of sensors
    SENSORS_PILOT_SHADOW = 16  # shadow rays of it
    SENSORS_TURN = 17  # by how much upright planes of sensors for cylindrical illuminance are turned
    YEAR_PATCHES = 18  # annual daylight: cosine lines of patches
    YEAR_PATCHES_SHADOW = 19  # shadow rays of patches through openings
    YEAR_SENSORS = 20  # cosine lines of sensors
    YEAR_SENSORS_SHADOW = 21  # shadow rays of sensors through openings
    YEAR_SUN = 22  # where rays to the sun begin on patches, and where on its disc they end
    REST = 23  # iterations of polynomials: whether the rest is dropped, a child each step
    ROUNDING = 2  # iterations: how many lines a patch fires, a child each step; they never meet the other purpose of this number


def stream(seed: Seed | int, replicate: int, purpose: Purpose, *child: int) -> np.random.SeedSequence:
    """An independent stream of a run's replicate (counted from 0 on within the run), or a child of it. The number of replicates
    does not matter."""
    seed = Seed.of(seed)
    return np.random.SeedSequence([seed.value, seed.first_replicate + replicate, int(purpose)], spawn_key=child)
