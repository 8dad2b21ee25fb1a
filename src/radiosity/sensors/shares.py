"""How lines are shared out among packets of sensors: by the variances that a pilot found."""

import numpy as np

PILOT = 16  # lines of each kind of each plane: of a pilot that is not short
LEAST = 0.1  # of the mean: the least share of lines of a packet
POWER = 0.435  # shares go as variance to this power, as those of patches do (`algorithms.gather.shares`)


def pooled(variance: np.ndarray, sizes: np.ndarray, pilot: int) -> np.ndarray:
    """Return variances of packets together with their neighbours, so that each comes from about as many lines as of a full pilot.

    A short pilot may miss lamps that a packet sees in part. It then finds no variance, and the packet would get too few lines.

    Args:
        variance: (kinds, count) float64, of packets, which follow each other along a curve.
        sizes: (count,) planes of each.
        pilot: its lines of each kind of each plane; with `PILOT` of them variances stay as they are.

    Example:
        >>> from radiosity.sensors.shares import pooled
        >>> pooled(np.array([[0.0, 0.0, 3.0, 0.0]]), np.ones(4, int), 8).tolist()
        [[0.0, 1.0, 1.0, 1.5]]
    """
    beside = PILOT // pilot // 2
    total, planes, count = np.zeros_like(variance), np.zeros(len(sizes)), len(sizes)
    for step in range(-beside, beside + 1):
        here, there = slice(max(-step, 0), count - max(step, 0)), slice(max(step, 0), count - max(-step, 0))
        if abs(step) < count:
            total[:, here] += (variance * sizes)[:, there]
            planes[here] += sizes[there]
    return total / planes


def of_packets(variance: np.ndarray, sizes: np.ndarray, *, has_targets: bool) -> np.ndarray:
    """Return the shares of lines of packets, (2, count); one in the mean over planes, both kinds together.

    Args:
        variance: (2, count), of cosine lines and shadow rays.
        sizes: (count,) planes of each.
        has_targets: there is something for shadow rays to find.
    """
    mean = float((variance.sum(axis=0) * sizes).sum() / sizes.sum())
    weight = (variance + 1e-2 * mean) ** POWER if mean > 0 else np.ones_like(variance)
    weight[1] *= has_targets
    each = weight.sum(axis=0)
    weight *= np.maximum(each, LEAST * each.mean()) / each
    return weight * (sizes.sum() / (weight.sum(axis=0) * sizes).sum())
