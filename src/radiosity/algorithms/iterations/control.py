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
from ...tally.shooter import Ends
from .exchange import BITS, LINE, Exchange
from .state import ControlState

SHARE = 8  # one line in 8 measures the share of missed lines


class Control:
    """The constants of all replicates and groups, and the share of its lines that each patch misses.

    Attributes:
        beta: (replicates, groups) float64, in units of Phi over the scene's area.
        missed: (2, replicates, n_patches) int64, probing lines escaped and lost.
        probed: (replicates, n_patches) int64, probing lines fired.
    """

    def __init__(self, exchange: Exchange):
        self.exchange, n, replicates = exchange, exchange.n, exchange.replicates
        self.beta = np.zeros((replicates, exchange.groups))
        self.missed = np.zeros((2, replicates, n), np.int64)
        self.probed = np.zeros((replicates, n), np.int64)
        self._kept: Any = None  # `kept` on the device

    def probe(self, lines: int) -> int:
        """Fire ``lines`` of each replicate, evenly over all area and at least one a patch, to count which are missed."""
        exchange, types = self.exchange, self.exchange.types
        counts = dr.maximum(exchange.counts(types.UInt64(exchange.area * dr.opaque(types.Float64, float(lines) * LINE))), 1)
        slots, groups, replicates = exchange.shooter.slots, exchange.groups, exchange.replicates
        carried = np.zeros((slots, groups), np.float32)
        carried[-2 * replicates : -replicates], carried[-replicates:] = 1, LINE
        ends = Ends(dr.opaque(types.Float, 0.5, slots), upload(types.Float, carried))
        fired = exchange.shoot(counts, ends=ends)
        seen = np.array(exchange.patches(exchange.shooter.received)).reshape(replicates, exchange.n, groups)[..., 0]
        self.missed += [seen % LINE, seen >> BITS]
        self._kept = None
        self.probed += np.array(counts, np.int64).reshape(replicates, exchange.n)
        return fired

    def kept(self) -> np.ndarray:
        """The share f_i of lines that hit patches, from all probing lines so far, (replicates, n_patches) float64."""
        return kept(self.missed, self.probed)

    def constant(self):
        """Return the power A_i beta / Phi of the constant on each patch, (total * groups,) Float64."""
        exchange = self.exchange
        return exchange.by_group(self.beta) * exchange.by_patch(exchange.area)

    def received(self):
        """Return the power f_i A_i beta / Phi that patches receive of the constant, (total * groups,) Float64."""
        if self._kept is None:
            self._kept = upload(self.exchange.types.Float64, self.kept())
        return self.constant() * self.exchange.by_patch(self._kept)

    def adapt(self, power) -> None:
        """Take the area-weighted median of the radiosity, where the lines' power, sum A |B - beta|, is least."""
        exchange = self.exchange
        value = np.array(power).reshape(exchange.replicates, exchange.n, exchange.groups) / exchange.areas[:, None]
        for replicate in range(exchange.replicates):
            for group in range(exchange.groups):
                self.beta[replicate, group] = median(value[replicate, :, group], exchange.areas)

    def capture(self) -> ControlState:
        """Return copies of the numbers."""
        beta, missed, probed = self.beta.copy(), self.missed.copy(), self.probed.copy()
        return ControlState(sizes=self.exchange.sizes, beta=beta, probe_missed=missed, probed=probed)

    def restore(self, state: ControlState) -> None:
        """Set the numbers to captured ones."""
        self.beta, self.missed, self.probed = state.beta.copy(), state.probe_missed.copy(), state.probed.copy()
        self._kept = None


def kept(missed: np.ndarray, probed: np.ndarray) -> np.ndarray:
    """Return the share of the probing lines that hit patches."""
    return 1 - missed.sum(axis=0) / np.maximum(probed, 1)


def median(values: np.ndarray, weights: np.ndarray) -> float:
    """Return the value at which the weights of smaller and of larger values are equal."""
    order = np.argsort(values)
    below = np.cumsum(weights[order])
    return float(values[order[np.searchsorted(below, below[-1] / 2)]])


def source_constant(emission: np.ndarray, reflectance: np.ndarray, areas: np.ndarray) -> float:
    """Return the constant for which the remaining source, sum A |E - (1 - rho) beta|, is least."""
    return median(emission / (1 - reflectance), areas * (1 - reflectance))
