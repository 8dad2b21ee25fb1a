"""The heat balance of a scene for one network: watts of surfaces, and temperatures."""

from dataclasses import dataclass

import numpy as np

from . import banded, grey
from .conditions import Conditions
from .network import Network
from .nodes import Nodes
from .planck import SIGMA


@dataclass(frozen=True, eq=False)
class Balance:
    """What the surfaces of a scene exchange.

    Attributes:
        exchange: (n_surfaces + 1, n_surfaces + 1) W from one surface straight to another, less what comes back; antisymmetric;
            the last one is the surroundings.
        temperature: (n_surfaces,) K, the fourth root of the area mean of T^4; NaN where no patch exchanges anything.
        radiosity: (n_surfaces,) W/m², area mean, above that of the reference.
        patch_heat: (n_patches,) W that each patch gives off.
        patch_temperature: (n_patches,) K.
    """

    exchange: np.ndarray
    temperature: np.ndarray
    radiosity: np.ndarray
    patch_heat: np.ndarray
    patch_temperature: np.ndarray

    @property
    def net(self) -> np.ndarray:
        """W that each surface, and the surroundings, give off, (n_surfaces + 1,)."""
        return self.exchange.sum(axis=1)


def reference(conditions: Conditions) -> float:
    """Return the temperature whose emission is subtracted everywhere, K: one of those given, so that equal ones give zeros."""
    given = conditions.temperature[np.isfinite(conditions.temperature)].tolist()
    given += [] if conditions.surroundings is None else [conditions.surroundings]
    return sorted(given)[len(given) // 2]


def above(temperature, reference: float):
    """Return sigma (T^4 - reference^4), W/m², without loss of digits where they are near each other."""
    temperature = np.asarray(temperature, float)
    return SIGMA * (temperature - reference) * (temperature + reference) * (temperature**2 + reference**2)


def kelvin(emission: np.ndarray, reference: float) -> np.ndarray:
    """Return the temperature of an emission that is ``emission`` above that of the reference; NaN below 0 K."""
    with np.errstate(invalid="ignore", divide="ignore"):  # 0 K is the logarithm of zero
        if reference == 0:
            return np.where(emission < 0, np.nan, np.abs(emission) / SIGMA) ** 0.25
        return reference * (1 + np.expm1(np.log1p(emission / (SIGMA * reference**4)) / 4))


def balance(network: Network, nodes: Nodes, conditions: Conditions, surface: np.ndarray) -> Balance:
    """Solve for radiosities and floating temperatures.

    Args:
        surface: (n_patches,) the surface of each patch.
    """
    base, k = reference(conditions), len(conditions.temperature)
    around = base if conditions.surroundings is None else conditions.surroundings
    if len(conditions.emissivity) == 1:
        emitted = above(nodes.temperature, base)
        radiosity, emission = grey.solve(network, nodes, conditions.emissivity[0], emitted, float(above(around, base)))
        radiosities, emitted_around = radiosity[None], [float(above(around, base))]
        temperature = np.where(nodes.fixed, nodes.temperature, kelvin(emission, base))
    else:
        edges = conditions.wavelengths
        radiosities, temperature = banded.solve(network, nodes, conditions.emissivity, edges, nodes.temperature, around, base)
        emission = above(temperature, base)
        emitted_around = banded.emissions(edges, np.array([around, base])) @ [1.0, -1.0]
    bands = list(zip(radiosities, emitted_around, strict=True))
    exchange = sum(network.between(j, float(m), surface, k) for j, m in bands)
    heat = sum(network.given_off(j, float(m)) for j, m in bands)
    found = ~nodes.left_out
    area = np.bincount(surface[found], network.area[found], k)
    whole = np.bincount(surface[found], (network.area * emission)[found], k)
    mean = np.divide(whole, area, out=np.full(k, np.nan), where=area > 0)
    of_surface = np.where(np.isnan(conditions.temperature), kelvin(mean, base), conditions.temperature)
    sent = np.bincount(surface, network.area * sum(radiosities), k) / np.maximum(np.bincount(surface, network.area, k), 1e-300)
    return Balance(np.asarray(exchange), of_surface, sent, np.asarray(heat), np.where(found, temperature, np.nan))
