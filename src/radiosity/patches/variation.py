"""How far light varies over faces: measured by a pilot, and expected from the pilot before."""

from dataclasses import dataclass

import numpy as np

from ..scene.model import Scene

SURE = 8.0  # times its noise: a variation that is larger is taken as measured, whatever was expected


@dataclass(frozen=True, eq=False)
class Variation:
    """Variances of reflected light over faces, and the noise in them; summed over sides and bands, (n_faces,) float64 each.

    Attributes:
        along, across: between the halves of a parallelogram along its first and its second edge.
        rest: what its four quarters differ by beyond that; of a triangle what its three parts differ by.
        noise: variance that noise alone would give a half.
        within_along, within_across: between quarters along an edge, within halves; 0 where it is not known.
    """

    along: np.ndarray
    across: np.ndarray
    rest: np.ndarray
    noise: np.ndarray
    within_along: np.ndarray
    within_across: np.ndarray

    def given(self, before: "Variation | None") -> "Variation":
        """Return the best estimate, in which what is lost in noise comes from an estimate before."""
        parts = (self.along, self.across, self.rest), (self.within_along, self.within_across)
        if before is None:
            halves, within = ([np.maximum(now, 0.0) for now in some] for some in parts)
        else:
            expected = (before.along, before.across, before.rest), (before.within_along, before.within_across)
            halves, within = (
                [_best(now, old, times * self.noise) for now, old in zip(*pair, strict=True)]
                for times, *pair in zip((1, 2), parts, expected, strict=True)
            )
        return Variation(halves[0], halves[1], halves[2], self.noise, within[0], within[1])

    def after(self, scene: Scene, columns: np.ndarray, rows: np.ndarray, part: np.ndarray, is_quad: np.ndarray) -> "Variation":
        """Return what is expected of the parts of faces that are cut: where light is smooth, a half varies by a quarter.

        Args:
            scene: of the faces. columns, rows: (n_faces,) how they are cut.
            part: (m,) the face of each part. is_quad: (m,) bool, it is a parallelogram.
        """
        long, wide = columns > 1, rows > 1
        along, across = np.where(long, self.along / 4, self.along), np.where(wide, self.across / 4, self.across)
        rest = np.where(long | wide, self.rest / 4, self.rest)
        new = is_quad & ~scene.is_quad[part]  # half of a triangle
        half = rest[part] / 2
        within = [np.where(cut, one / 4, one) for cut, one in ((long, self.within_along), (wide, self.within_across))]
        return Variation(
            np.where(new, half, along[part]),
            np.where(new, half, across[part]),
            np.where(new, 0.0, rest[part]),
            self.noise[part],
            *(one[part] for one in within),
        )


def _best(now: np.ndarray, expected: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Return the mean of what was measured and expected, weighted by what either may err by."""
    variance = 2 * noise**2 + 4 * noise * np.maximum(now, 0)
    total = expected**2 + variance
    weight = np.divide(expected**2, total, out=np.ones_like(total), where=total > 0)
    weight = np.where(now > SURE * noise, 1.0, weight)
    return np.maximum(weight * now + (1 - weight) * expected, 0.0)
