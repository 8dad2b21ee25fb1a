"""Hierarchical radiosity from beginning to end, and its result."""

from dataclasses import dataclass

import numpy as np

from ...patches import Patches
from ...tracing.geometry import Geometry
from .indicated import indicated
from .levels import Levels
from .links import Links
from .making import Told
from .parameters import Hierarchical
from .rounds import Pass, Rounds


@dataclass(frozen=True, eq=False)
class HierarchicalResult:
    """The result of hierarchical radiosity.

    Attributes:
    irradiance, radiosity: (n_patches, n_bands) float64, W/m² or lm/m².
    indicated: (n_patches, n_bands) float64: the errors of irradiance of all links, summed without their signs and sent on as
        light is (equation 6 of the paper): well above the true error. NaN for brightness-factor, which gives no error.
    links, hidden: the number of links at the end, and of those that carry nothing, since no ray came through.
    elements: the number of elements in the trees that the links need.
    pairs: form factors computed, also for links that were replaced later.
    rays: rays traced.
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
    """Solve B = E + rho H over links of elements whose leaves are the patches.

    The same arguments give the same bits.

    Args:
        patches: patches cut by ``subdivide(..., powers_of_two=True)``.
        geometry: the same patches on a device; None: there are no obstacles between faces, and no rays are traced.
        parameters: the parameters.
        told: called between batches with the rays traced since; it may raise.

    Raises:
        SceneError: patches that are no leaves of a hierarchy.
        MethodError: more links than fit into memory.
    """
    rounds = Rounds(patches, geometry, parameters or Hierarchical(), told)
    while not rounds.done:
        rounds.advance()
    levels, links, irradiance = rounds.levels, rounds.links, rounds.irradiance
    radiosity = patches.emission + patches.reflectance * irradiance
    return HierarchicalResult(
        irradiance,
        radiosity,
        indicated(rounds),
        len(links),
        int((links.factor == 0).sum()),
        _elements(levels, links),
        rounds.maker.pairs,
        rounds.maker.rays,
        tuple(rounds.history),
        links,
    )


def _elements(levels: Levels, links: Links) -> int:
    """Return the number of elements at the ends of links, of those that hold them, and of the siblings of all; no clusters."""
    used = np.zeros(len(levels.area), bool)
    used[links.receiver] = used[links.source] = True
    divided = np.zeros_like(used)
    for element in reversed(levels.below):
        parent = levels.parent[element]
        divided[parent[(used | divided)[element]]] = True
    roots, clusters = len(levels.hierarchy.side_face), levels.clusters
    within = levels.below if clusters is None else levels.below[len(clusters.below) + 1 :]
    return roots + sum(int(divided[levels.parent[element]].sum()) for element in within)
