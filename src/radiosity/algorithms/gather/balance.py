"""The balance of power: what lamps emit is absorbed by surfaces, leaves the scene, or is lost.

Each patch measures what it receives by lines of its own, so that nothing makes the powers of all patches agree with what lamps
emit. The imbalance of a replicate has three causes, whose sizes are told apart by their variances:

- errors of the even part of the light, which all lines read alike: they make all patches too bright or too dark together;
- errors of each patch by itself, which it has alone;
- errors of what misses all patches, which say nothing of what patches receive. The share of lines is known with an error; and
  where light varies over a patch, the lines that miss may leave from where it is bright, or from where it is dark.

So the imbalance goes to all patches in proportion to their power, to each patch in proportion to its variance (the least-squares
adjustment under one condition), and what the third cause explains is left. So is an imbalance that all replicates have alike, if
it is more than the bias of stored lines: where faces stand twice, the power that both receive is more than lamps emit.
"""

import numpy as np

from ...patches.scatter import Scatter

BY_CHANCE = 3.0  # standard errors: a mean imbalance beyond them has another cause, such as faces that stand twice
LIMITS = (0.75, 4 / 3)  # of what a patch is multiplied by: where a few patches have most of the variance, the adjustment is rough


def factors(
    own: np.ndarray,
    scatter: Scatter,
    received: np.ndarray,
    missed: np.ndarray,
    lines: np.ndarray,
    bias: np.ndarray | float = 0.0,
    varies: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Return what to multiply received powers by, (replicates, n_patches), so that the power of each replicate balances.

    Args:
        own: (n_patches,) emitted power.
        scatter: what patches send on, of one group.
        received: (replicates, n_patches) received power.
        missed: (replicates, n_patches) how many lines of each patch missed all others.
        lines: (n_patches,) how many lines each patch fired.
        bias: (n_patches,) the size of the bias of received power.
        varies: (n_patches,) the standard deviation of received power over the places of each patch.
    """
    received, missed = np.ascontiguousarray(received), np.ascontiguousarray(missed)  # sums depend on how arrays lie in memory
    if len(received) < 2:  # nothing tells what causes its imbalance
        return np.ones_like(received)
    share, mean = missed / lines, received.mean(axis=0)
    taken, sends = 1 - scatter.albedo, scatter.in_column
    sent = own + sends.of_rows(received, 0)
    imbalance = own.sum() - (received * taken).sum(axis=1) - (sent * share).sum(axis=1)
    explained = BY_CHANCE * imbalance.std(ddof=1) / len(received) ** 0.5 + float(np.sum(bias * taken))
    if abs(imbalance.mean()) > explained:
        imbalance = imbalance - imbalance.mean()
    usual = share.mean(axis=0)
    # replicates together, and one line more that hits: all lines of a patch may miss by chance
    likely = np.where(usual > 0, np.minimum(usual, 1 - 1 / (lines * len(received) + 2)), 0.0)
    reaches = taken + scatter.of(usual)
    variance = np.minimum(received.var(axis=0, ddof=1), mean**2)
    alone = float((reaches**2 * variance).sum())
    of_missed = float((sent**2 * (likely * (1 - likely) / lines)).sum()) / len(received)
    # the covariance of light and misses over a patch, at most (Cauchy and Schwarz)
    of_missed += float((scatter.of(np.broadcast_to(varies, mean.shape)) * np.sqrt(usual * (1 - usual))).sum()) ** 2
    whole = max(float((imbalance**2).mean()), alone + of_missed)
    if whole == 0:
        return np.ones_like(received)
    absorbed = received * (taken + sends.of_rows(share, 0))
    even = (1 - (alone + of_missed) / whole) * _ratio(imbalance, absorbed.sum(axis=1))
    relative = _ratio(reaches * variance, mean)
    of_each = alone / whole * _ratio(imbalance, (absorbed * relative).sum(axis=1))
    return np.clip(1 + even[:, None] + of_each[:, None] * relative, *LIMITS)


def _ratio(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.divide(one, other, out=np.zeros(len(one)), where=other > 0)
