"""The webs of luminaires as tables of one array each, and their look-up and inversion in kernels.

The share of the power that leaves between two entries of gamma is known in closed form: over the planes C the mean intensity is
linear in gamma, a + s g, and the integral of (a + s g) sin g is a polynomial where entries are close. A direction is drawn
from that share first, and then C along the row of its gamma, where the intensity is linear piece by piece.
"""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...scene.lights.web import Web

WIDEST = np.radians(5.0)  # between two entries of gamma: the polynomial then holds to single precision
STEPS = 22  # of the bisection of an interval of gamma
BELOW_ONE = 1 - 2.0**-22  # keeps a number below the whole, however it is rounded


@dataclass(eq=False)
class WebTables:
    """Several webs. Each has a head of four words: where its entries of gamma, of planes and of intensities begin, and the counts
    of gamma and planes in one word.

    Attributes:
        webs: the webs, no two alike.
    """

    webs: tuple[Web, ...]
    heads: np.ndarray = field(default_factory=lambda: np.zeros((0, 4), np.uint32), init=False)
    _types: Any = field(default=None, init=False)
    _steps: tuple[int, int] = field(default=(0, 0), init=False)
    _gamma: Any = field(default=None, init=False)  # rad
    _planes: Any = field(default=None, init=False)  # rad
    _sums: Any = field(default=None, init=False)  # the share of the power below each entry of gamma
    _pieces: Any = field(default=None, init=False)  # 8 floats an entry of gamma, see `_pieces_of`
    _intensity: Any = field(default=None, init=False)  # share of the power per sr; a row for each entry of gamma
    _along: Any = field(default=None, init=False)  # integral of it over C, from 0 to each plane

    def prepare(self, types: Any) -> None:
        """Put the tables on a device."""
        self._types = types
        tables = [_Tables.of(web) for web in self.webs]
        counts = np.array([(len(one.gamma), len(one.planes)) for one in tables])
        begins = np.cumsum([(0, 0, 0), *((g, p, g * p) for g, p in counts)], axis=0)[:-1]
        self.heads = np.column_stack([begins, counts[:, 0] << 16 | counts[:, 1]]).astype(np.uint32)
        most = counts.max(axis=0)
        self._steps = (int(most[0] - 2).bit_length(), int(most[1] - 2).bit_length())

        def joined(name: str):
            return upload(types.Float, np.concatenate([getattr(one, name).ravel() for one in tables]).astype(np.float32))

        self._gamma, self._planes, self._sums = joined("gamma"), joined("planes"), joined("sums")
        self._pieces, self._intensity, self._along = joined("pieces"), joined("intensity"), joined("along")

    # ---- in kernels ------------------------------------------------------------------------------------------------

    def draw(self, head: Any, first: Any, second: Any) -> tuple[Any, Any]:
        """Return C and gamma, rad, in proportion to the intensity, from two numbers in [0, 1)."""
        Float = type(first)
        n_gamma, n_planes = head[3] >> 16, head[3] & 0xFFFF
        row = _last(lambda i: dr.gather(Float, self._sums, head[0] + i) <= second, n_gamma, self._steps[0])
        piece, c = (dr.gather(self._types.Array4f, self._pieces, (head[0] + row) * 2 + half) for half in (0, 1))
        x = _inverse((second - piece[2]) * piece[3], [*c, 1 - (c[0] + c[1] + c[2] + c[3])])
        gamma = dr.fma(x, piece[1], piece[0])
        at = head[2] + row * n_planes

        def between(table, j):
            low = dr.gather(Float, table, at + j)
            return dr.fma(x, dr.gather(Float, table, at + n_planes + j) - low, low)

        wanted = first * BELOW_ONE * between(self._along, n_planes - 1)
        plane = _last(lambda j: between(self._along, j) <= wanted, n_planes, self._steps[1])
        low, high = dr.gather(Float, self._planes, head[1] + plane), dr.gather(Float, self._planes, head[1] + plane + 1)
        start, end = between(self._intensity, plane), between(self._intensity, plane + 1)
        rest = dr.maximum(wanted - between(self._along, plane), 0) / (high - low)
        root = dr.sqrt(dr.maximum(dr.fma(start, start, 2 * (end - start) * rest), 0))
        y = dr.clip(2 * rest / dr.maximum(start + root, 1e-30), 0, 1)
        return dr.fma(y, high - low, low), gamma

    def share(self, head: Any, plane: Any, gamma: Any) -> Any:
        """Return the share of the power that leaves per sr in a direction; C in [0, 2 pi] and gamma in rad."""
        Float = type(gamma)
        n_gamma, n_planes = head[3] >> 16, head[3] & 0xFFFF
        row = _last(lambda i: dr.gather(Float, self._gamma, head[0] + i) <= gamma, n_gamma, self._steps[0])
        column = _last(lambda j: dr.gather(Float, self._planes, head[1] + j) <= plane, n_planes, self._steps[1])
        x = _part(self._gamma, head[0] + row, gamma)
        y = dr.clip(_part(self._planes, head[1] + column, plane), 0, 1)
        at = head[2] + row * n_planes + column
        near, far = (
            dr.lerp(dr.gather(Float, self._intensity, i), dr.gather(Float, self._intensity, i + 1), y)
            for i in (at, at + n_planes)
        )
        return dr.select((x >= 0) & (x <= 1), dr.lerp(near, far, x), 0)


def _last(holds, count: Any, steps: int) -> Any:
    """Return the last of the first count - 1 entries for which ``holds`` is true, or 0. It is true up to some entry."""
    found = dr.zeros(type(count))
    for step in reversed(range(steps)):
        new = found + (1 << step)
        found = dr.select((new < count - 1) & holds(dr.minimum(new, count - 1)), new, found)
    return found


def _inverse(value: Any, coefficients: list) -> Any:
    """Return x in [0, 1] where a rising polynomial without a constant term has a value."""
    x = dr.zeros(type(value))
    for step in range(1, STEPS + 1):
        new = x + 0.5**step
        power = coefficients[-1]
        for one in reversed(coefficients[:-1]):
            power = dr.fma(power, new, one)
        x = dr.select(power * new <= value, new, x)
    return x


def _part(entries: Any, index: Any, value: Any) -> Any:
    """Return where a value lies between an entry and the next, 0 to 1."""
    Float = type(value)
    low, high = dr.gather(Float, entries, index), dr.gather(Float, entries, index + 1)
    return (value - low) / (high - low)


@dataclass(frozen=True, eq=False)
class _Tables:
    """The tables of one web, float64; see `WebTables`."""

    gamma: np.ndarray
    planes: np.ndarray
    intensity: np.ndarray
    along: np.ndarray
    sums: np.ndarray
    pieces: np.ndarray

    @staticmethod
    def of(web: Web) -> "_Tables":
        """Make them: one plane becomes two, and wide intervals of gamma are cut, which changes nothing between their entries."""
        planes = np.array([0.0, 360.0]) if len(web.planes) == 1 else web.planes
        rows = np.broadcast_to(web.intensity, (len(planes), len(web.gamma))).T / web.flux  # a row an entry of gamma
        entries = np.radians(web.gamma)
        cuts = [np.linspace(a, b, int(np.ceil((b - a) / WIDEST - 1e-9)), endpoint=False) for a, b in pairwise(entries)]
        gamma = np.append(np.concatenate(cuts), entries[-1])
        of_plane = [np.interp(gamma, entries, column) for column in rows.T]
        intensity, planes = np.stack(of_plane, axis=1), np.radians(planes)
        steps = (intensity[:, 1:] + intensity[:, :-1]) / 2 * np.diff(planes)
        along = np.concatenate([np.zeros((len(gamma), 1)), np.cumsum(steps, axis=1)], axis=1)
        sums, pieces = _pieces_of(gamma, along[:, -1])
        return _Tables(gamma, planes, intensity, along, sums, pieces)


def _pieces_of(gamma: np.ndarray, whole: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the share of the power below each entry of gamma, (n,), and what `WebTables.draw` reads of each interval, (n, 8).

    That is its first gamma, its width, the share below it, 1 / its own share, and coefficients of x to x^4; that of x^5 makes
    their sum 1. The last entry begins no interval.

    Args:
        whole: (n,) the intensity integrated over C, share of the power per rad of C.
    """
    width = np.diff(gamma)
    sine, cosine = np.sin(gamma[:-1]), np.cos(gamma[:-1])
    a, s = whole[:-1], np.diff(whole) / width
    # the integral from 0 to d of (a + s x) sin(gamma + x) dx, by the series of sine and cosine of x
    of_power = [
        sine * a,
        (sine * s + cosine * a) / 2,
        cosine * s / 3 - sine * a / 6,
        -(sine * s / 8 + cosine * a / 24),
        sine * a / 120 - cosine * s / 30,
    ]
    terms = np.array([of_power[i] * width ** (i + 1) for i in range(5)])
    own = np.maximum(terms.sum(axis=0), 0)
    below = np.concatenate([[0], np.cumsum(own)])
    inverse = np.divide(1, own, out=np.zeros_like(own), where=own > 0)
    pieces = np.zeros((len(gamma), 8))
    pieces[:-1] = np.column_stack([gamma[:-1], width, below[:-1] / below[-1], below[-1] * inverse, *(terms[:4] * inverse)])
    return below / below[-1], pieces
