"""A constant control variate: a radiosity beta is taken out of what lines carry, and put back exactly.

H_i = sum_j F_ij B_j = beta f_i + sum_j F_ij (B_j - beta), where f_i = sum_j F_ij is 1 in a closed scene and 1 less the share of
its lines that patch i misses in any other. Probing lines, fired for this alone, measure that share, so the form holds in open
scenes, too: exactly where nothing is missed, and else with the error of these lines. (P. Bekaert, "Hierarchical and
stochastic algorithms for radiosity", thesis, K. U. Leuven 1999; docs/iterations.md.)
"""

from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...tally.scores import Ends
from .exchange import BITS, LINE, Exchange
from .state import ControlState

UNIT = 2**20  # fixed point units of one missed line, in moments
SHARE = 8  # one line in 8 measures the share of missed lines


class Control:
    """The constants of all replicates and groups, and the share of its lines that each patch misses.

    Attributes:
        beta: (replicates, columns) float64, in units of Phi over the scene's area; 0 in columns of other functions than 1.
        missed: (2, replicates, n_patches) int64, probing lines escaped and lost.
        moments: (replicates, n_patches, K - 1) int64, the sums of the other functions where missed lines begin, times `UNIT`.
        probed: (replicates, n_patches) int64, probing lines fired.
    """

    def __init__(self, exchange: Exchange):
        self.exchange, n, replicates = exchange, exchange.n, exchange.replicates
        self.beta = np.zeros((replicates, exchange.columns))
        self.missed = np.zeros((2, replicates, n), np.int64)
        self.moments = np.zeros((replicates, n, exchange.basis.size - 1), np.int64)
        self.probed = np.zeros((replicates, n), np.int64)
        self._kept: Any = None  # `kept` on the device

    def probe(self, lines: int) -> int:
        """Fire ``lines`` of each replicate, evenly over all area and at least one a patch, to count which are missed.

        There are `MOST` at most.
        """
        exchange, types = self.exchange, self.exchange.types
        counts = dr.maximum(exchange.counts(types.UInt64(exchange.area * dr.opaque(types.Float64, float(lines) * LINE))), 1)
        fired = self._probe(counts) if exchange.basis.size == 1 else self._probe_moments(counts)
        self._kept = None
        self.probed += np.array(counts, np.int64).reshape(exchange.replicates, exchange.n)
        return fired

    def _probe(self, counts) -> int:
        exchange, types = self.exchange, self.exchange.types
        slots, groups, replicates = exchange.shooter.slots, exchange.groups, exchange.replicates
        carried = np.zeros((slots, groups), np.float32)
        carried[-2 * replicates : -replicates], carried[-replicates:] = 1, LINE
        ends = Ends(dr.opaque(types.Float, 0.5, slots), upload(types.Float, carried))
        fired = exchange.shoot(counts, ends=ends)
        seen = np.array(exchange.patches(exchange.shooter.scores.received)).reshape(replicates, exchange.n, groups)[..., 0]
        self.missed += [seen % LINE, seen >> BITS]
        return fired

    def _probe_moments(self, counts) -> int:
        """Count missed lines as two groups of bands see them: one sees those that escape, the other those that are lost."""
        exchange, types = self.exchange, self.exchange.types
        slots, size, replicates = exchange.shooter.slots, exchange.basis.size, exchange.replicates
        carried = np.zeros((slots, 2, size), np.float32)
        carried[-2 * replicates : -replicates, 0, 0], carried[-replicates:, 1, 0] = UNIT, UNIT
        ends = Ends(dr.opaque(types.Float, 0.5, slots), upload(types.Float, carried), groups=2)
        fired = exchange.shoot(counts, ends=ends)
        seen = np.array(exchange.shooter.scores.received)[: exchange.total * 2 * size].reshape(replicates, exchange.n, 2, size)
        self.missed += np.moveaxis(seen[..., 0], 2, 0) // UNIT
        self.moments += seen[..., 1:].sum(axis=2)
        return fired

    def kept(self) -> np.ndarray:
        """The share f_i of lines that hit patches, and its other moments, (replicates, n_patches, K) float64."""
        return moments_kept(self.missed, self.moments, self.probed)

    def constant(self):
        """Return the power A_i beta / Phi of the constant on each patch, (total * columns,) Float64."""
        exchange = self.exchange
        return exchange.by_column(self.beta) * exchange.by_patch(exchange.area)

    def received(self):
        """Return the power f_i A_i beta / Phi that patches receive of the constant, and its moments, (total * columns,)."""
        if self._kept is None:
            kept = np.tile(self.kept(), self.exchange.groups)
            self._kept = upload(self.exchange.types.Float64, kept)
        exchange, size = self.exchange, self.exchange.basis.size
        constant = np.repeat(self.beta[:, ::size], size, axis=1)
        return exchange.by_column(constant) * exchange.by_patch(exchange.area) * self._kept

    def adapt(self, power) -> None:
        """Take the area-weighted median of the radiosity, where the lines' power, sum A |B - beta|, is least."""
        exchange = self.exchange
        value = np.array(power).reshape(exchange.replicates, exchange.n, exchange.columns) / exchange.areas[:, None]
        for replicate in range(exchange.replicates):
            for group in range(0, exchange.columns, exchange.basis.size):
                self.beta[replicate, group] = median(value[replicate, :, group], exchange.areas)

    def capture(self) -> ControlState:
        """Return copies of the numbers."""
        beta, missed, probed = self.beta.copy(), self.missed.copy(), self.probed.copy()
        moments = self.moments.copy() if self.exchange.basis.size > 1 else None
        return ControlState(sizes=self.exchange.sizes, beta=beta, probe_missed=missed, probed=probed, probe_moments=moments)

    def restore(self, state: ControlState) -> None:
        """Set the numbers to captured ones."""
        self.beta, self.missed, self.probed = state.beta.copy(), state.probe_missed.copy(), state.probed.copy()
        if state.probe_moments is not None:
            self.moments = state.probe_moments.copy()
        self._kept = None


def kept(missed: np.ndarray, probed: np.ndarray) -> np.ndarray:
    """Return the share of the probing lines that hit patches."""
    return 1 - missed.sum(axis=0) / np.maximum(probed, 1)


def moments_kept(missed: np.ndarray, moments: np.ndarray | None, probed: np.ndarray) -> np.ndarray:
    """Return the share of the probing lines that hit patches, and its other moments, (replicates, n_patches, K) float64."""
    first = kept(missed, probed)[..., None]
    if moments is None:
        return first
    return np.concatenate([first, -moments / (UNIT * np.maximum(probed, 1))[..., None]], axis=2)


def median(values: np.ndarray, weights: np.ndarray) -> float:
    """Return the value at which the weights of smaller and of larger values are equal."""
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return float(values[order[np.searchsorted(below, below[-1] / 2)]])


def source_constant(emission: np.ndarray, reflectance: np.ndarray, areas: np.ndarray) -> float:
    """Return the constant for which the remaining source, sum A |E - (1 - rho) beta|, is least."""
    return median(emission / (1 - reflectance), areas * (1 - reflectance))
