"""Polynomials from what a few stored lines find: least squares with a penalty.

What m lines say of K coefficients has a relative variance of about K / m. In a solution along stored lines, noise of a patch
comes back to it, and in a narrow gap all of it does: there it would grow, were coefficients the moments alone. So the mean is as
it is, and the others are c = (C + e)^-1 cov(phi, v), where C is the covariance of the functions over the lines and e a penalty of
1/4 or more. Then |c|² <= var(v) / (4 e): the mean square of a polynomial is at most that of the values that it comes from. The
penalty is in proportion to 1 / m, so that solutions along halves of the lines know of the bias that it makes.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr

from ...device.recorded import loop
from .shares import OF_FUNCTION
from .stored_lines import StoredLines

PENALTY = OF_FUNCTION / 4  # times K / m: 1/4 at the most lines that are stored


@dataclass(frozen=True, eq=False)
class Fit:
    """A triangular decomposition L D L' of C + e for each lane.

    Attributes:
        means: Float each, of the functions after the first, over the lines of each lane.
        lower: of row k, the k entries of L before the diagonal, which is 1.
        diagonal: Float each, D.
    """

    means: list
    lower: list[list]
    diagonal: list

    @staticmethod
    def of(lines: StoredLines, begin: Any, end: Any) -> "Fit":
        """Make it from stored lines.

        Args:
            lines: with a basis of several functions.
            begin, end: UInt32 (lanes,), the lines of each lane that count: at least one.
        """
        packets, basis = lines.packets, lines.basis
        types, size = packets.types, basis.size - 1
        lane, lanes = dr.arange(types.UInt32, packets.lanes), dr.opaque(types.UInt32, packets.lanes)
        pairs = [(k, l) for k in range(size) for l in range(k + 1)]
        dr.eval(lane)

        def body(number, *sums):
            spot, _ = lines.spots(number * lanes + lane)
            functions = basis.functions(spot.a, spot.b, spot.select)[1:]
            more = [*functions, *(functions[k] * functions[l] for k, l in pairs)]
            return (number + 1, *(total + value for total, value in zip(sums, more, strict=True)))

        zeros = (dr.zeros(types.Float, packets.lanes) for _ in range(size + len(pairs)))
        _, *sums = loop((types.UInt32(begin), *zeros), lambda number, *sums: number < end, body)
        count = types.Float(dr.maximum(end - begin, 1))
        means = [total / count for total in sums[:size]]
        matrix = {pair: total / count - means[pair[0]] * means[pair[1]] for pair, total in zip(pairs, sums[size:], strict=True)}
        lower: list[list] = [[] for _ in range(size)]
        diagonal: list = []
        for k in range(size):
            matrix[k, k] += PENALTY * basis.size / count
            for l in range(k):
                known = sum(lower[k][i] * lower[l][i] * diagonal[i] for i in range(l))
                lower[k].append((matrix[k, l] - known) / diagonal[l])
            diagonal.append(matrix[k, k] - sum(lower[k][i] ** 2 * diagonal[i] for i in range(k)))
        dr.eval(means, lower, diagonal)
        return Fit(means, lower, diagonal)

    def centred(self, moments: list) -> list:
        """Return covariances of values with the functions, after the mean, from K moments of the values."""
        return [moments[0], *(one - moments[0] * mean for one, mean in zip(moments[1:], self.means, strict=True))]

    def polynomial(self, centred: list) -> list:
        """Return K coefficients from what `centred` returned."""
        size, found = len(self.diagonal), []
        for k in range(size):
            found.append(centred[k + 1] - sum(self.lower[k][i] * found[i] for i in range(k)))
        found = [one / pivot for one, pivot in zip(found, self.diagonal, strict=True)]
        for k in reversed(range(size)):
            found[k] = found[k] - sum(self.lower[i][k] * found[i] for i in range(k + 1, size))
        return [centred[0], *found]
