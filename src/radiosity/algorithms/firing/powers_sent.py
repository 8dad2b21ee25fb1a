"""The check that powers of bands belong to the lines of their state, before a run goes on from it."""

from typing import Any

import numpy as np

from ...device.backend import frozen
from ...errors import MethodError
from ...solution.books import exact_sum
from .counters import FiringCounters


def check_sent(counters: FiringCounters, powers: Any) -> None:
    """Refuse powers that patches have sent, where they are not those of the lines that were fired or are left of a wavefront.

    What a wavefront's lines carry is sent when it is fixed, and fired line by line. So the power sent is that fired and, within
    a wavefront that is fired in parts, what the lines carry that are left of it.

    Args:
        counters: at the state, at its number of quanta.
        powers: the `BandState` that they were set to.

    Raises:
        MethodError: it is not, in some replicate and group.
    """
    bands, tracer = counters.bands, counters.tracer
    assert bands is not None
    if (powers.wavefront_arrivals is None) != (powers.wavefront_weights is None) or (bands.parted and not powers.within):
        raise MethodError("the solution to go on from lacks a part of its wavefront; take an earlier checkpoint, or start anew")
    left: np.ndarray | None = None
    if bands.parted:
        targets = counters.target_counts_before(counters.rows())
        left = frozen(targets - counters.fired).reshape(tracer.replicates, tracer.n)
    for replicate in range(tracer.replicates):
        for group in range(bands.n):
            fired = powers.exact("fired_power", (group, replicate))
            if left is not None:
                fired += exact_sum(powers.wavefront_weights[replicate, :, group].astype(np.uint64) * left[replicate])
            if fired != powers.exact("sent", (replicate, slice(None), group)):
                raise MethodError(
                    f"the solution to go on from is not whole: in its replicate {replicate}, lines of group {group} of bands do "
                    "not carry what patches have sent; take an earlier checkpoint, or start anew"
                )
