"""Radiosities and temperatures where emissivities depend on wavelength: grey bands, which floating temperatures couple.

Where all temperatures are given, each band is a grey exchange of its own. A floating node gives off a sum over bands, each with
its share of Planck's law, so that its temperature is found by Newton's method. A step is one sparse system for the radiosities
of all bands and the emissions of all nodes, solved by stabilised biconjugate gradients. The first guess is grey.
"""

import numpy as np

from ..errors import SceneError
from . import grey
from .network import Network
from .nodes import Nodes
from .planck import SIGMA, band_shares, band_slopes

STEPS = 40
TOLERANCE = 1e-9  # of emissions, relative to the largest difference between emissions: Newton's method ends
LINEAR = 1e-12  # of the residual of a step


def solve(
    network: Network, nodes: Nodes, emissivity: np.ndarray, edges, temperature: np.ndarray, surroundings: float, reference: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the sum over bands of A (J - H), as (n_bands, n) radiosities less the reference, and temperatures, (n,) K.

    Args:
        emissivity: (n_bands, n).
        temperature: (n,) K of patches of given temperature; not read on others.
        surroundings, reference: K.
    """
    fixed = nodes.fixed
    kelvin = np.where(fixed, temperature, reference)
    zero = emissions(edges, np.array([reference]))[:, 0]
    around = emissions(edges, np.array([surroundings]))[:, 0] - zero
    if len(nodes.heat):
        kelvin[~fixed] = _floating(network, nodes, emissivity, edges, kelvin, around, zero)[nodes.node[~fixed]]
    emitted = emissions(edges, kelvin) - zero[:, None]
    held = Nodes(kelvin, np.full(len(kelvin), -1), np.zeros(0), nodes.left_out)
    each = zip(emissivity, emitted, around, strict=True)
    return np.array([grey.solve(network, held, e, m, s)[0] for e, m, s in each]), kelvin


def emissions(edges, temperature: np.ndarray) -> np.ndarray:
    """What a black surface emits in each band, (n_bands, n) W/m²."""
    return band_shares(edges, temperature) * (SIGMA * temperature**4)


def _floating(network, nodes, emissivity, edges, kelvin, around, zero) -> np.ndarray:
    """The temperatures of floating nodes, (n_nodes,) K."""
    from scipy.sparse import block_array, coo_array, diags_array
    from scipy.sparse.linalg import bicgstab

    n, bands, count = len(kelvin), len(emissivity), len(nodes.heat)
    floats = np.flatnonzero(~nodes.fixed)
    pick = coo_array((np.ones(len(floats)), (floats, nodes.node[floats])), shape=(n, count)).tocsr()
    laplacian = (diags_array(network.whole) - network.exchange).tocsr()
    area, escaping = network.area, network.escaping
    fixed_emission = np.where(nodes.fixed, emissions(edges, kelvin) - zero[:, None], 0.0)
    of_node = np.array([pick.T @ (area * e) for e in emissivity])  # (bands, nodes)
    rows = [diags_array(e) + diags_array((1 - e) / area) @ laplacian for e in emissivity]
    hidden = np.zeros(count, bool)
    hidden[nodes.node[nodes.left_out]] = True  # any temperature is right
    seen = diags_array(np.where(hidden, 0.0, 1.0)) @ pick.T
    gathers = [seen @ (diags_array(e) @ laplacian - diags_array(e * area)) for e in emissivity]

    shares = band_shares(edges, kelvin.max(keepdims=True))[:, 0]
    _, guess = grey.solve(network, nodes, shares @ emissivity, fixed_emission.sum(axis=0), float(around.sum()))
    total = np.full(count, zero.sum())
    total[nodes.node[floats]] += guess[floats]
    scale = float(np.ptp(np.append(fixed_emission.sum(axis=0)[nodes.fixed], around.sum())))
    scale = max(scale, float(np.abs(total - zero.sum()).max(initial=0.0)), np.finfo(float).tiny)
    least = 1e-6 * max(total.max(initial=0.0), scale)
    state = None
    for _ in range(STEPS):
        total = np.maximum(total, least)
        temperature = (total / SIGMA) ** 0.25
        emission, slope = emissions(edges, temperature) - zero[:, None], band_slopes(edges, temperature)
        columns = [-(diags_array(e) @ pick @ diags_array(s)) for e, s in zip(emissivity, slope, strict=True)]
        blocks = [[rows[b] if b == c else None for c in range(bands)] + [columns[b]] for b in range(bands)]
        corner = diags_array(np.where(hidden, 1.0, (of_node * slope).sum(axis=0)))
        matrix = block_array([*blocks, [*gathers, corner]]).tocsr()
        start = emission - slope * (total - zero.sum())  # bands at a total of the reference, by the tangent
        right = [
            e * (fixed_emission[b] + pick @ start[b]) + (1 - e) / area * escaping * around[b] for b, e in enumerate(emissivity)
        ]
        sent = sum(pick.T @ (e * escaping) * around[b] for b, e in enumerate(emissivity))
        balance = np.where(hidden, 0.0, nodes.heat + sent - (of_node * start).sum(axis=0))
        right = np.concatenate([*right, balance])
        inverse = diags_array(1 / matrix.diagonal())
        x, failed = bicgstab(matrix, right, x0=state, rtol=LINEAR, atol=0.0, M=inverse, maxiter=20 * grey.MOST)
        state, new = x, x[bands * n :] + zero.sum()
        change = float(np.abs(new - total)[~hidden].max(initial=0.0))
        total = np.where(hidden, zero.sum(), new)
        if change <= TOLERANCE * scale and not failed:
            break
    else:
        raise SceneError(
            f"the temperatures of surfaces that float did not settle within {STEPS} steps (bands of wavelength couple them); "
            "check the fluxes: a surface may give off more than it could at any temperature"
        )
    return (np.maximum(total, 0.0) / SIGMA) ** 0.25
