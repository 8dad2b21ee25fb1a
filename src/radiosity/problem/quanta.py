"""The target count of each patch, in integers (contract 2).

With energy packets delta = Phi / N, the target count of patch i is floor(E_i A_i / delta + rho_i h_i + phase_i) after h_i hits.
On a diffusing pane tau_i h_j is added, where h_j are the hits of its other side. All terms are fixed point numbers with a 32-bit
fraction, so the sum is exact and the same everywhere.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..errors import SceneError
from ..patches.model import Patches
from ..patches.scatter import Scatter
from ..pieces import pieces
from ..sampling.streams import Purpose, Seed, stream

ONE = 2.0**32
WORD = np.uint64(32)  # bits
LIMIT = 2**62  # lines of a replicate: what is counted of them fits in 64 bits


@dataclass(frozen=True, eq=False)
class Source:
    """A scene's scalar problem, for the integers of contract 2. Its rows are the patches, then the lights without area.

    Attributes:
        share: (n_rows,) float64, E_i A_i / Phi.
        rho: (n_rows,) uint32, reflectance times 2^32.
        power: Phi, W or lm.
        tau: (n_rows,) uint32, diffuse transmittance times 2^32; None where nothing diffuses light.
        other: (n_rows,) uint32, the row on the other side of each; None where nothing diffuses light.
    """

    share: np.ndarray
    rho: np.ndarray
    power: float
    tau: np.ndarray | None = None
    other: np.ndarray | None = None

    @staticmethod
    def of(
        patches: Patches,
        emission: np.ndarray,
        reflectance: np.ndarray,
        area: np.ndarray | None = None,
        through: np.ndarray | None = None,
        other: np.ndarray | None = None,
    ) -> "Source":
        """Make it from scalar emission, reflectance and area of rows, (n_rows,) each; the area is that of the patches by default.

        Args:
            through: (n_rows,) diffuse transmittance, and ``other`` the row on the other side of each; None where there is none.

        Raises:
            SceneError: nothing emits.
        """
        power = emission * (patches.area if area is None else area)
        try:
            total = math.fsum(power)
        except OverflowError:
            total = math.inf
        if total == math.inf:
            raise SceneError(f"{patches.scene.source}: the total power is too large for numbers; check emission and unit")
        if not (math.isfinite(total) and total > 0):
            raise SceneError(
                f"{patches.scene.source}: no surface emits (total power {total:g} {patches.scene.power_unit}); "
                "give one an emission: in the file where its format has lights, else by power = 40 for a surface in a .toml "
                "(docs/scene-toml.md)"
            )
        tau = None if through is None else Source.fixed(through)
        return Source(power / total, Source.fixed(reflectance), total, tau, None if other is None else other.astype(np.uint32))

    @property
    def least_absorbed(self) -> float:
        """The least share of received light that rows do not send on."""
        return 1 - int((self.rho if self.tau is None else self.rho + self.tau).max()) / ONE

    @staticmethod
    def fixed(reflectance: np.ndarray) -> np.ndarray:
        """Return reflectance in [0, 1) times 2^32, uint32."""
        fixed = np.empty(reflectance.shape, np.uint32)
        for part in pieces(len(fixed)):
            fixed[part] = np.floor(reflectance[part] * ONE)
        return fixed

    @staticmethod
    def fixed_albedo(scatter: Scatter, group: int) -> np.ndarray:
        """Return the share of received light that is sent on, of one group, times 2^32, (n,) uint32.

        Diffuse transmittance is equal on both sides of a pane, so sums over all patches count what crosses, too.
        """
        rho = Source.fixed(scatter.reflectance[:, group])
        return rho if scatter.through is None else rho + Source.fixed(scatter.through[:, group])

    def sent_on(self, arrivals: np.ndarray, part: slice = slice(None)) -> np.ndarray:
        """Return what rows send on for hit counts of all rows, (..., n_rows): of some of them, in 2^-32ths, uint64.

        It is modulo 2^64 where hit counts have more than 32 bits.
        """
        sent = self.rho[part].astype(np.uint64) * arrivals[..., part].astype(np.uint64)
        if self.tau is None or self.other is None:
            return sent
        return sent + self.tau[part].astype(np.uint64) * arrivals[..., self.other[part]].astype(np.uint64)

    def emitted(self, quanta: int) -> tuple[np.ndarray, np.ndarray]:
        """Return E_i A_i / delta at N quanta: whole lines and 2^-32ths, uint32 each. It never falls when N grows.

        Whole lines are uint64 where 32 bits do not suffice.
        """
        many = float(self.share.max()) * quanta >= ONE
        whole, fraction = np.empty(len(self.share), np.uint64 if many else np.uint32), np.empty(len(self.share), np.uint32)
        for part, *both in self._emitted(quanta):
            whole[part], fraction[part] = both
        return whole, fraction

    def emitted_in_all(self, quanta: int) -> int:
        """Return the sum of E_i A_i / delta over all rows, in 2^-32ths."""
        return sum((int(whole.sum()) << 32) + int(fraction.sum()) for _, whole, fraction in self._emitted(quanta))

    def _emitted(self, quanta: int) -> Iterator[tuple[slice, np.ndarray, np.ndarray]]:
        for part in pieces(len(self.share)):
            lines = self.share[part] * quanta
            whole = np.floor(lines)
            yield part, whole.astype(np.uint64), np.floor((lines - whole) * ONE).astype(np.uint64)


def phases(seed: Seed | int, replicates: int, n_patches: int) -> np.ndarray:
    """Return the rounding offset of each patch, uniform, (replicates, n_patches) uint32."""
    result = np.empty((replicates, n_patches), np.uint32)
    for replicate in range(replicates):
        generator = np.random.Generator(np.random.Philox(stream(seed, replicate, Purpose.PHASE)))
        result[replicate] = generator.integers(0, 2**32, n_patches, dtype=np.uint32)
    return result


def target_counts(source: Source, quanta: int, arrivals: np.ndarray, phase: np.ndarray) -> np.ndarray:
    """Return the target counts of contract 2 on the host, (..., n_patches) uint64: for the energy balance and for tests."""
    whole, fraction = source.emitted(quanta)
    hits = np.asarray(arrivals, np.uint64)
    low = source.sent_on(hits & np.uint64(2**32 - 1)) + fraction.astype(np.uint64) + phase.astype(np.uint64)
    return whole.astype(np.uint64) + (low >> WORD) + source.sent_on(hits >> WORD)
