"""The balance of power: what lamps emit is absorbed by surfaces, leaves the scene, or is lost.

Each patch measures what it receives by lines of its own, so that nothing makes the powers of all patches agree with what lamps
emit. The imbalance of a replicate has three causes, whose sizes are told apart by their variances:

- errors of the even part of the light, which all lines read alike: they make all patches too bright or too dark together;
- errors of each patch by itself, which it has alone;
- errors of the share of lines that miss all patches, which say nothing of what patches receive.

So the imbalance goes to all patches in proportion to their power, to each patch in proportion to its variance (the least-squares
adjustment under one condition), and what the third cause explains is left.
"""

import numpy as np

LIMITS = (0.5, 2.0)  # of what a patch is multiplied by: where a few patches have most of the variance, the adjustment is rough


def factors(own: np.ndarray, reflectance: np.ndarray, received: np.ndarray, missed: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Return what to multiply received powers by, (replicates, n_patches), so that the power of each replicate balances.

    Args:
        own: (n_patches,) emitted power.
        reflectance: (n_patches,).
        received: (replicates, n_patches) received power.
        missed: (replicates, n_patches) how many lines of each patch missed all others.
        lines: (n_patches,) how many lines each patch fired.
    """
    received, missed = np.ascontiguousarray(received), np.ascontiguousarray(missed)  # sums depend on how arrays lie in memory
    share, mean = missed / lines, received.mean(axis=0)
    sent = own + reflectance * received
    imbalance = own.sum() - (received * (1 - reflectance)).sum(axis=1) - (sent * share).sum(axis=1)
    usual = share.mean(axis=0)  # replicates together: in one of them all lines of a patch may miss, or none, by chance
    taken = 1 - reflectance + reflectance * usual
    variance = np.minimum(received.var(axis=0, ddof=1), mean**2) if len(received) > 1 else np.zeros(len(mean))
    alone = float((taken**2 * variance).sum())
    of_missed = float((sent**2 * (usual * (1 - usual) / lines)).sum()) / len(received)
    whole = max(float((imbalance**2).mean()), alone + of_missed)
    if whole == 0:
        return np.ones_like(received)
    absorbed = received * (1 - reflectance + reflectance * share)
    even = (1 - (alone + of_missed) / whole) * _ratio(imbalance, absorbed.sum(axis=1))
    relative = _ratio(taken * variance, mean)
    of_each = alone / whole * _ratio(imbalance, (absorbed * relative).sum(axis=1))
    return np.clip(1 + even[:, None] + of_each[:, None] * relative, *LIMITS)


def _ratio(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.divide(one, other, out=np.zeros(len(one)), where=other > 0)
