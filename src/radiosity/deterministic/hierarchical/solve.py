"""Hierarchical radiosity: refine, solve, and refine for the solution found, with smaller and smaller epsilon."""

from dataclasses import dataclass

import numpy as np

from ...engine.geometry import Geometry
from ...patches import Hierarchy, Patches
from .exchange import Exchange
from .levels import Levels
from .links import Links
from .making import Maker, Told
from .oracle import Oracle, Radiosity
from .parameters import Hierarchical
from .refine import refined
from .roots import root_pairs

ROUGH = 1e-3  # tolerance of solutions that links are refined for


@dataclass(frozen=True)
class Pass:
    """One solution with given links.

    Attributes:
        epsilon: of its links.
        links: how many.
        change: the largest change of a radiosity since the pass before, over the largest radiosity of its band.
    """

    epsilon: float
    links: int
    change: float


@dataclass(frozen=True, eq=False)
class HierarchicalResult:
    """Attributes:
    irradiance, radiosity: (n_patches, n_bands) float64, W/m² or lm/m².
    indicated: (n_patches, n_bands) float64: the errors of irradiance of all links, summed without their signs and sent on as
        light is (equation 6 of the paper): well above the true error. NaN for brightness-factor, which tells no error.
    links, hidden: how many at the end, and how many of them carry nothing, since no ray came through.
    elements: how many there are in the trees that the links ask for.
    pairs: form factors computed, for links replaced later too.
    rays: traced.
    history: every pass.
    final: the links themselves.
    """

    irradiance: np.ndarray
    radiosity: np.ndarray
    indicated: np.ndarray
    links: int
    hidden: int
    elements: int
    pairs: int
    rays: int
    history: tuple[Pass, ...]
    final: Links


def solve_hierarchical(
    patches: Patches, geometry: Geometry | None = None, parameters: Hierarchical | None = None, told: Told = lambda rays: None
) -> HierarchicalResult:
    """B = E + rho H over links of elements whose leaves are the patches.

    The same arguments give the same bits.

    Args:
        patches: cut by ``subdivide(..., powers_of_two=True)``.
        geometry: the same patches on a device; None: nothing stands between any two faces, and no rays are traced.
        parameters: epsilon and the rest.
        told: called between batches with the rays traced since; it may raise.

    Raises:
        SceneError: patches that are no leaves of a hierarchy.
        MethodError: more links than there is room for.
    """
    parameters = parameters or Hierarchical()
    hierarchy = Hierarchy(patches)
    levels = Levels(hierarchy)
    oracle = Oracle(levels, parameters)
    maker = Maker(geometry if parameters.rays else None, hierarchy, parameters, told)
    links = Links.joined([maker.make(*root_pairs(hierarchy))])
    emission, reflectance = patches.emission, patches.reflectance
    irradiance, history = np.zeros_like(emission), []
    for epsilon in parameters.rounds:
        new = True
        while new:
            before = emission + reflectance * irradiance
            links, new = refined(links, oracle, maker, Radiosity.of(levels, before), epsilon)
            if new or not history:
                irradiance = Exchange(levels, links).solve(emission, reflectance, irradiance, ROUGH, told)
                change = _change(before, emission + reflectance * irradiance)
                history.append(Pass(epsilon, len(links), change))
    exchange = Exchange(levels, links)
    irradiance = exchange.solve(emission, reflectance, irradiance, parameters.tolerance, told)
    radiosity = emission + reflectance * irradiance
    indicated = np.full_like(radiosity, np.nan)
    if oracle.by_error:
        here, there = oracle.parts(links, Radiosity.of(levels, radiosity))
        own = _delta(levels, links, here + there)
        indicated = own + exchange.solve(reflectance * own, reflectance, np.zeros_like(own), ROUGH, told)
    return HierarchicalResult(
        irradiance, radiosity, indicated, len(links), int((links.factor == 0).sum()), _elements(levels, links),
        maker.pairs, maker.rays, tuple(history), links,
    )  # fmt: skip


def _change(before: np.ndarray, after: np.ndarray) -> float:
    largest = after.max(axis=0)
    return float((np.abs(after - before).max(axis=0) / np.where(largest > 0, largest, 1)).max())


def _delta(levels: Levels, links: Links, errors: np.ndarray) -> np.ndarray:
    """(n_patches, n_bands): the errors of all links that reach a patch, summed."""
    columns = [np.bincount(links.receiver, weights=band, minlength=len(levels.area)) for band in errors.T]
    return levels.push(np.stack(columns, axis=1))


def _elements(levels: Levels, links: Links) -> int:
    """Elements at the ends of links, those that hold them, and the siblings of all."""
    used = np.zeros(len(levels.area), bool)
    used[links.receiver] = used[links.source] = True
    divided = np.zeros_like(used)
    for element in reversed(levels.below):
        parent = levels.parent[element]
        divided[parent[(used | divided)[element]]] = True
    roots = len(levels.hierarchy.side_face)
    return roots + sum(int(divided[levels.parent[element]].sum()) for element in levels.below)
