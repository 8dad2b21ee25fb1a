"""The nearest exchange areas that are symmetric, not negative, and close: a least-squares problem with few multipliers.

Minimise sum_k (x_k - a_k)² / v_k over x >= 0 such that the x of each group sum to its area. An unknown x_k is a pair of groups,
which counts in the sums of both, or what a group sends to itself or out of the scene, which counts in one. With a multiplier u_i
for each group the minimum is

    x_k = max(0, a_k + v_k (u_i + u_j)),

and u maximises a concave function whose slope is what the sums lack. Newton's method with a line search finds it: between two
changes of the set of x_k that are zero the function is a parabola. M. Held, P. Wolfe and H. P. Crowder, "Validation of
subgradient optimization", Mathematical Programming 6, 1974, has the dual; Newton's matrix is one row and column for each group.
"""

from dataclasses import dataclass

import numpy as np

CLOSED = 1e-13  # of a group's area: steps end when no sum is further off
ENOUGH = 1e-12  # of a group's area: otherwise there is no solution
STEPS = 200
REGULAR = 1e-13  # added to the scaled matrix: groups that see only each other have one multiplier too many


@dataclass(frozen=True, eq=False)
class Unknowns:
    """Exchange areas that are looked for.

    Attributes:
        one, other: (m,) int, the groups in whose sums each counts; equal where it counts once.
        values: (m,) a_k, what was measured, m².
        variance: (m,) v_k, m⁴; zero holds a value as it is.
        wanted: (n,) the sum of each group, m².
    """

    one: np.ndarray
    other: np.ndarray
    values: np.ndarray
    variance: np.ndarray
    wanted: np.ndarray

    def sums(self, x: np.ndarray) -> np.ndarray:
        """Return the sum of each group, (n,)."""
        n, twice = len(self.wanted), self.one != self.other
        return np.bincount(self.one, x, n) + np.bincount(self.other[twice], x[twice], n)

    def moved(self, u: np.ndarray) -> np.ndarray:
        """Return v_k (u_i + u_j), or v_k u_i where x_k counts once, (m,); u may have columns, (n, r)."""
        second = np.where((self.one != self.other).reshape(-1, *[1] * (u.ndim - 1)), u[self.other], 0)
        return self.variance.reshape(-1, *[1] * (u.ndim - 1)) * (u[self.one] + second)

    def matrix(self, free: np.ndarray) -> np.ndarray:
        """Return Newton's matrix, (n, n): how sums follow multipliers, where only ``free`` unknowns move."""
        n, v, twice = len(self.wanted), np.where(free, self.variance, 0.0), self.one != self.other
        across = np.bincount(self.one[twice] * n + self.other[twice], v[twice], n * n).reshape(n, n)
        result = (across + across.T).astype(np.float64)
        result[np.diag_indices(n)] += self.sums(v)
        return result


@dataclass(frozen=True, eq=False)
class Nearest:
    """The solution.

    Attributes:
        values: (m,) x, m².
        closes: False where no values within reach sum to what is wanted.
        unknowns: the problem.
        free: (m,) bool, which unknowns are not held at zero.
    """

    values: np.ndarray
    closes: bool
    unknowns: Unknowns
    free: np.ndarray

    @property
    def variance(self) -> np.ndarray:
        """The variances of the values, (m,) m⁴, if those of the measured ones are right and independent."""
        own, n = self.unknowns, len(self.unknowns.wanted)
        inverse = _solve(own.matrix(self.free), np.eye(n))
        twice = own.one != own.other
        along = inverse[own.one, own.one] + np.where(twice, inverse[own.other, own.other] + 2 * inverse[own.one, own.other], 0)
        return np.where(self.free, np.maximum(own.variance * (1 - own.variance * along), 0), 0)

    def of_samples(self, samples: np.ndarray) -> np.ndarray:
        """Return what each of r other measurements would have given, (r, m), with the same unknowns at zero."""
        own = Unknowns(self.unknowns.one, self.unknowns.other, samples, self.unknowns.variance, self.unknowns.wanted)
        held = np.where(self.free, samples, 0.0)
        lacking = np.stack([own.wanted - own.sums(row) for row in held], axis=1)
        move = own.moved(_solve(own.matrix(self.free), lacking))
        return np.where(self.free, samples + move.T, 0.0)


def nearest(unknowns: Unknowns) -> Nearest:
    """Solve the problem of this file."""
    wanted, u = unknowns.wanted, np.zeros(len(unknowns.wanted))
    scale = np.where(wanted > 0, wanted, 1.0)

    def at(u: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        x = np.maximum(unknowns.values + unknowns.moved(u), 0)
        lacking = wanted - unknowns.sums(x)
        return x, lacking, float(np.abs(lacking / scale).max(initial=0.0))

    x, lacking, worst = at(u)
    for _ in range(STEPS):
        if worst <= CLOSED:
            break
        free = (x > 0) | (unknowns.values + unknowns.moved(u) >= 0)
        step = _solve(unknowns.matrix(free), lacking)
        along, rise = 1.0, float(lacking @ step)
        if not (np.isfinite(rise) and rise > 0):
            break
        for _ in range(60):  # until the slope along the step has not turned: then the concave function has risen
            new = at(u + along * step)
            if float(new[1] @ step) >= -0.1 * rise:
                break
            along /= 2
        u = u + along * step
        if new[2] >= worst and worst <= ENOUGH:
            break
        x, lacking, worst = new
    return Nearest(x, worst <= ENOUGH, unknowns, x > 0)


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solve by a scaled and slightly regular matrix; columns of ``right`` may be many."""
    diagonal = matrix.diagonal()
    root = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    scaled = matrix / root[:, None] / root + REGULAR * np.eye(len(root))
    wide = right.reshape(len(root), -1) / root[:, None]
    return (np.linalg.solve(scaled, wide) / root[:, None]).reshape(right.shape)
