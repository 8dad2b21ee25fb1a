"""Streams of random numbers: every purpose has a name, and a stream of its own.

The number of a purpose is part of what a seed means: another number would change the bits of all runs that use it.
"""

from enum import IntEnum

import numpy as np


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
    ROUNDING = 2  # iterations: how many lines a patch fires, a child each step; they never meet the other purpose of this number


def stream(seed: int, replicate: int, purpose: Purpose, *child: int) -> np.random.SeedSequence:
    """Return an independent stream of a replicate, or a child of it. The number of replicates does not matter."""
    return np.random.SeedSequence([seed, replicate, int(purpose)], spawn_key=child)
