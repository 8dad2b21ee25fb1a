"""Areas of polygons."""

import numpy as np


def area(polygon: np.ndarray) -> float:
    """The area of a counterclockwise polygon, (k, 2)."""
    after = np.roll(polygon, -1, axis=0)
    return (polygon[:, 0] @ after[:, 1] - polygon[:, 1] @ after[:, 0]) / 2
