"""Watts and temperatures from counted lines, with standard errors."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ..errors import SceneError, shown
from ..factors.counted import CountedPairs
from ..patches.model import Patches
from ..solution.intervals import by_luck
from . import few_lines, openings
from .balance import Balance, above, balance, reference
from .conditions import Conditions
from .jackknife import Jackknife
from .network import Network, Pooled
from .nodes import Nodes
from .panes import of_solid
from .planck import SIGMA

MOST = 4000  # surfaces: their matrices then take 1 GB


@dataclass(frozen=True, eq=False)
class Estimate:
    """What surfaces exchange, by lines.

    Attributes:
        exchange, exchange_error: (k + 1, k + 1) W, see `Balance`.
        net, net_error: (k + 1,) W, the last one of the surroundings; exact where the heat is given.
        temperature, temperature_error: (k,) K.
        patch_heat, patch_heat_error: (n_patches,) W.
        patch_temperature: (n_patches,) K.
        lines: (k + 1,) lines that joined each surface to others.
    """

    exchange: np.ndarray
    exchange_error: np.ndarray
    net: np.ndarray
    net_error: np.ndarray
    temperature: np.ndarray
    temperature_error: np.ndarray
    patch_heat: np.ndarray
    patch_heat_error: np.ndarray
    patch_temperature: np.ndarray
    lines: np.ndarray


class Estimator:
    """Solves for counted lines of a scene under given conditions."""

    def __init__(self, patches: Patches, conditions: Conditions):
        openings.refuse_one_way(patches)
        if len(patches.scene.names) > MOST:
            raise SceneError(
                f"{len(patches.scene.names):,} surfaces would exchange heat in a matrix of as many rows; {MOST:,} are the "
                "most: give surfaces that belong together one name"
            )
        self.patches = patches
        self.conditions = replace(conditions, emissivity=of_solid(patches, conditions.emissivity))

    @cached_property
    def floats(self) -> np.ndarray:
        """Surfaces whose heat is given and not their temperature, (k,) bool."""
        return np.isnan(self.conditions.temperature)

    def estimate(self, pairs: CountedPairs, *, tell: bool = True) -> Estimate:
        """Solve with all lines, and without one replicate each.

        Args:
            pairs: the lines.
            tell: warn of lines that escape or end on backs.

        Raises:
            SceneError: lines escape and there are no surroundings, nothing gives a surface its temperature, or it gives off more
                heat than it could.
        """
        conditions, patches = self.conditions, self.patches
        pooled, surface = Pooled(pairs), patches.surface
        if tell:
            openings.check(patches, pooled, conditions.surroundings)
        network = openings.closed(pooled.network, conditions.surroundings)
        hidden = network.whole == 0
        heat = np.where(self.floats, np.nan_to_num(conditions.flux), 0.0)
        nodes = Nodes.of(patches, conditions.temperature, heat, conditions.isothermal, hidden)
        self._refuse_adrift(nodes, network)
        whole = balance(network, nodes, conditions, surface)
        self._refuse_cold(whole, nodes)
        sums = {name: Jackknife(value) for name, value in self._values(whole).items()}
        for one in pooled.without_one():
            part = openings.closed(one, conditions.surroundings)
            values = self._values(balance(part, nodes, conditions, surface))
            lost = nodes.adrift(part, surroundings=conditions.surroundings is not None) & ~nodes.left_out & ~nodes.fixed
            for name, value in values.items():
                sums[name].add(np.full(value.shape, np.nan) if lost.any() else value)
        return self._with_few(pooled, network, whole, sums)

    @staticmethod
    def _values(found: Balance) -> dict[str, np.ndarray]:
        return {
            "exchange": found.exchange,
            "net": found.net,
            "temperature": found.temperature,
            "heat": found.patch_heat,
            "patch temperature": found.patch_temperature,
        }

    def _with_few(self, pooled: Pooled, network: Network, whole: Balance, sums: dict[str, Jackknife]) -> Estimate:
        """The estimate, with errors of exchange that few lines cannot show."""
        conditions, surface, k = self.conditions, self.patches.surface, len(self.floats)
        around = conditions.surroundings
        emitted = None if around is None else float(above(around, reference(conditions)))
        value = {name: np.where(np.isfinite(one.value), one.value, one.whole) for name, one in sums.items()}
        error = {name: one.error for name, one in sums.items()}
        agreed = by_luck(value["exchange"], error["exchange"])
        few = few_lines.watts(pooled, self.patches, whole.radiosity, emitted, agreed)
        of_net = np.sqrt((few**2).sum(axis=1))
        net, net_error = value["net"], np.hypot(error["net"], of_net)
        net[:k][self.floats], net_error[:k][self.floats] = np.nan_to_num(conditions.flux[self.floats]), 0.0  # NaN: no patch
        conductance = np.bincount(surface, network.whole, k)
        slope = 4 * SIGMA * np.maximum(value["temperature"], np.finfo(float).tiny) ** 3 * conductance
        with np.errstate(divide="ignore", invalid="ignore"):
            off = np.where(of_net[:k] > 0, of_net[:k] / slope, 0.0)
        temperature = np.where(self.floats, value["temperature"], conditions.temperature)
        counts = pooled.between(surface, k)
        counts[np.arange(k), np.arange(k)] = 0
        return Estimate(
            value["exchange"],
            np.hypot(error["exchange"], few),
            net,
            net_error,
            temperature,
            np.where(self.floats, np.hypot(error["temperature"], off), 0.0),
            value["heat"],
            error["heat"],
            np.clip(value["patch temperature"], 0, None),
            np.append(counts.sum(axis=1), counts[:, k].sum()),
        )

    def _refuse_adrift(self, nodes: Nodes, network: Network) -> None:
        adrift = nodes.adrift(network, surroundings=self.conditions.surroundings is not None) & ~nodes.fixed
        surface, names = self.patches.surface, self.patches.scene.names
        bad = np.unique(surface[adrift & ~nodes.left_out]).tolist()
        unseen = set(np.unique(surface[nodes.left_out])) - set(np.unique(surface[~nodes.left_out]))
        bad = sorted({*bad, *unseen})
        if bad:
            raise SceneError(
                f"the temperature of {shown([names[i] for i in bad])} is not determined: they exchange heat with no surface of "
                "given temperature, and with no surroundings; give one of them a temperature"
            )

    def _refuse_cold(self, found: Balance, nodes: Nodes) -> None:
        cold = np.isnan(found.patch_temperature) & ~nodes.left_out
        if cold.any():
            i = int(self.patches.surface[np.flatnonzero(cold)[0]])
            raise SceneError(
                f"surface '{self.patches.scene.names[i]}' would be below 0 K somewhere: a flux of {self.conditions.flux[i]:g} W "
                "is more heat than it can take from the others"
            )
