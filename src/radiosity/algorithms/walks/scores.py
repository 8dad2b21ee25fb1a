"""The scores of hits, and the power that particles carry (the estimators of random walks; M. Sbert 1997, section 3)."""

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...method.model import Method
from ...patches.bases import BASES
from ...problem.model import Problem
from ...tally.wraps import Wraps
from ...tracing.line_tracer import LineTracer
from ...tracing.spots import Spot
from ..merge_rules import words
from .state import WalkState

UNIT = 2**24  # fixed point units of a quantum: as fine as a weight in single precision


class Scores:
    """Power received by every patch, as an estimator sees it.

    With w the power that a particle brings to patch i, and p_i the chance to survive there, a hit scores w (collision),
    w / (1 - p_i) where the walk ends (absorption), or w / p_i where it goes on (survival; a black patch, where none goes on,
    scores w). Each has the mean w, so that all of them estimate the power received. p_i is the largest reflectance of the bands;
    in each band the particle goes on with w rho_i / p_i. On a diffusing pane p_i is the sum of the largest reflectance and the
    largest diffuse transmittance, and a particle goes on from either side with the chance that each has in it.

    Attributes:
        survival: Float (n_patches,), p.
        stays: Float (n_patches,), the part of p with which particles stay on their side; None where nothing diffuses light.
        carries: True where particles have powers of their own; else all carry one quantum.
        weighted: True where ``received`` is kept; else only hits are counted.
        received: UInt64, group g of a slot at slot * n_groups + g, in `UNIT`, modulo 2^64; ``upper`` has the upper words.
        basis: of the light on patches.
        moments: Int64, the scores times the K - 1 functions of the basis after the first, where hits lie: those of group g of a
            slot from (slot * n_groups + g) * (K - 1) on, in `UNIT`; None where the basis has one function.
        fired: power that left along lines, summed from the lines' side, for each group.
    """

    def __init__(self, tracer: LineTracer, problem: Problem, method: Method):
        self.tracer, self.estimator = tracer, method.estimator
        types, groups = tracer.types, problem.groups
        self.n = groups.n_groups
        reflectance = groups.reflectance.max(axis=1)
        self.fractional = method.absorption == "fractional"
        through = None if groups.through is None else groups.through.max(axis=1)
        self.survival = upload(types.Float, (reflectance if through is None else reflectance + through).astype(np.float32))
        self.stays = None if through is None else upload(types.Float, reflectance.astype(np.float32))
        self.carries = self.n > 1 or self.fractional
        self.weighted = self.carries or method.estimator != "collision"
        if self.carries:
            top = groups.emission.max(axis=1)
            share = groups.emission / np.where(top > 0, top, 1)[:, None]
            kept = 1.0 if self.fractional else np.where(reflectance > 0, reflectance, 1)[:, None]
            ratio = groups.reflectance / kept
            across = ratio if through is None else groups.through / np.where(through > 0, through, 1)[:, None]
            self.shares, self.ratios, self.ratios_across = (
                [upload(types.Float, column.astype(np.float32)) for column in x.T] for x in (share, ratio, across)
            )
        if self.weighted:
            self.received = dr.opaque(types.UInt64, 0, tracer.slots * self.n)
            self.upper = Wraps(types, 64)
        self.basis, self.moments = BASES[method.basis], None
        if self.basis.size > 1:
            self.moments = dr.opaque(types.Int64, 0, tracer.slots * self.n * (self.basis.size - 1))
        self.fired = [0] * self.n

    def arrays(self) -> tuple:
        """The arrays that kernels write to."""
        received = (self.received,) if self.weighted else ()
        return received if self.moments is None else (*received, self.moments)

    def born(self, number) -> tuple:
        """Return the power that particles of patch numbers carry at first."""
        if not self.carries:
            return ()
        patch = number - self.tracer.replicate(number) * self.tracer.n_opaque
        return tuple(dr.gather(self.tracer.types.Float, share, patch) for share in self.shares)

    def fixed(self, weights) -> tuple:
        """Return weights in fixed point, rounded."""
        types = self.tracer.types
        return tuple(types.UInt64(weight * float(UNIT) + 0.5) for weight in weights)

    def count_fired(self, weights, lines: int, real=True) -> None:
        """Add the power of lines that leave to ``fired``."""
        if not self.carries:
            self.add_fired([lines * (UNIT if self.weighted else 1)] * self.n)
            return
        sums = [dr.sum(dr.select(real, fixed, 0)) for fixed in self.fixed(weights)]
        dr.eval(sums)
        self.add_fired([int(total[0]) for total in sums])

    def add_fired(self, power: list[int]) -> None:
        """Add power to ``fired``."""
        self.fired = [before + new for before, new in zip(self.fired, power, strict=True)]

    def deposit(self, weights, slot, patch, probability, alive, real, mode, spot: Spot | None = None) -> None:
        """Score lines that hit slots; called in a kernel. Slots of no patch score what the lines bring.

        Args:
            spot: where they hit patches; only where there are moments.
        """
        one = self.tracer.types.Float(1)
        if spot is not None:
            on = real & (slot < self.tracer.total)
            functions = self.basis.functions(spot.a, spot.b, spot.select)[1:]
            for g in range(self.n):
                score = self._score(weights[g] if self.carries else one, probability, alive) * float(UNIT)
                for k, value in enumerate(functions):
                    column = (slot * self.n + g) * len(functions) + k
                    moment = self.tracer.types.Int64(dr.round(score * value))
                    dr.scatter_add(self.moments, moment, column, active=on, mode=mode)
        if not self.weighted:
            return
        for g in range(self.n):
            brought = weights[g] if self.carries else one
            (score,) = self.fixed((self._score(brought, probability, alive),))
            dr.scatter_add(self.received, score, slot * self.n + g, active=real, mode=mode)

    def _score(self, brought, probability, alive):
        if self.estimator == "absorption":
            return dr.select(alive, 0, brought / (1 - probability))
        if self.estimator == "survival":
            return dr.select(probability > 0, dr.select(alive, brought / probability, 0), brought)
        return brought

    def across(self, number, patch, on):
        """Return which particles go on from the other side of a diffusing pane; None where nothing diffuses light.

        Args:
            number: of each particle, in [0, 1): below its chance to survive where it goes on.
        """
        if self.stays is None:
            return None
        return on & (number >= dr.gather(self.tracer.types.Float, self.stays, patch, on))

    def reflected(self, weights, patch, on, factor, across=None) -> tuple:
        """Return the power that goes on from a hit; ``factor`` restores the power of walks that a fixed share ended."""
        if not self.carries:
            return ()
        Float = self.tracer.types.Float
        ratios = [dr.gather(Float, ratio, patch, on) for ratio in self.ratios]
        if across is not None:
            far = [dr.gather(Float, ratio, patch, on) for ratio in self.ratios_across]
            ratios = [dr.select(across, one, other) for one, other in zip(far, ratios, strict=True)]
        return tuple(w * r * (1 if factor is None else factor) for w, r in zip(weights, ratios, strict=True))

    def look(self) -> None:
        """Note which sums wrapped around."""
        if self.weighted:
            self.upper.look(self.received)

    def read(self) -> dict[str, np.ndarray | None]:
        """Copy the sums to the host, by the names that `WalkState` has."""
        tracer, (low, much) = self.tracer, words(self.fired)
        found: dict[str, np.ndarray | None] = {"fired_power": low, "fired_power_upper": much}
        if not self.weighted:
            return found
        split, upper = tracer.total * self.n, self.upper.read(self.received)
        for flat, kind in ((frozen(self.received), ""), (upper, "_upper")):
            if flat is not None:
                found[f"received{kind}"] = flat[:split].reshape(tracer.replicates, tracer.n, self.n)
                found[f"received_missed{kind}"] = flat[split:].reshape(2, tracer.replicates, self.n)
        return found

    def write(self, state: WalkState) -> None:
        """Set the sums to those of a state."""
        self.fired, rows, missed = state.fired_in_all, state.received, state.received_missed
        if rows is None or missed is None:
            return
        upper = None
        if state.received_upper is not None or state.received_missed_upper is not None:
            pairs = ((rows, state.received_upper), (missed, state.received_missed_upper))
            upper = np.concatenate([np.ravel(np.zeros(low.shape, np.uint32) if x is None else x) for low, x in pairs])
        flat = self.upper.of(np.concatenate([rows.ravel(), missed.ravel()]), upper)
        self.received = upload(self.tracer.types.UInt64, flat)

    def read_moments(self) -> np.ndarray | None:
        """Copy the moments of patches to the host, (replicates, n_patches, n_groups, K - 1) int64."""
        if self.moments is None:
            return None
        each = self.n * (self.basis.size - 1)
        flat = frozen(self.moments)[: self.tracer.total * each]
        return flat.reshape(self.tracer.replicates, self.tracer.n, self.n, self.basis.size - 1)

    def write_moments(self, moments: np.ndarray | None) -> None:
        """Set the moments to what `read_moments` returned."""
        if moments is not None:
            behind = np.zeros(2 * self.tracer.replicates * self.n * (self.basis.size - 1), np.int64)
            self.moments = upload(self.tracer.types.Int64, np.concatenate([moments.ravel(), behind]))
