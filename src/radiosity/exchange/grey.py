"""Radiosities and temperatures of grey surfaces: one symmetric system, by conjugate gradients.

A patch of emissivity e has J = e M + (1 - e) H, where M is what a black surface would emit and H what it receives. So it gives
off A (J - H) = A e / (1 - e) (M - J): a conductance between M and J. A black patch has J = M. A node that gets Q watts from
elsewhere has the sum of A (J - H) over its patches equal to Q, and a patch that is such a node alone has
M = J + Q (1 - e) / (e A).
So M and J are potentials in a network of positive conductances. Its matrix is symmetric and positive definite also where nothing
absorbs (adiabatic walls, e near 0), where iterations of B = E + rho F B do not end.

All potentials are differences to a reference. Nothing else depends on it, so that small differences do not drown.
"""

import warnings

import numpy as np

from ..errors import RadiosityWarning
from .network import Network
from .nodes import Nodes

TOLERANCE = 1e-12  # of the residual, relative to the right side, in the norm of the preconditioner
TOLD = 1e-8  # above it there is a warning
MOST = 5000  # iterations at least; a system of n unknowns may take 4 n


def solve(
    network: Network, nodes: Nodes, emissivity: np.ndarray, emitted: np.ndarray, surroundings: float, guess=None
) -> tuple[np.ndarray, np.ndarray]:
    """Return radiosity J and black emission M of all patches, (n,) W/m² each, less the reference.

    Args:
        emissivity: (n,) in (0, 1].
        emitted: (n,) M of patches of given temperature, less the reference; not read on others.
        surroundings: M of the surroundings, less the reference.
        guess: (n,) J to begin with.
    """
    from scipy.sparse import coo_array, diags_array

    n, fixed, black = len(emissivity), nodes.fixed, emissivity >= 1
    size = np.bincount(nodes.node[~fixed], minlength=len(nodes.heat))
    alone, shared = np.zeros((2, n), bool)
    alone[~fixed], shared[~fixed] = size[nodes.node[~fixed]] == 1, size[nodes.node[~fixed]] > 1
    with np.errstate(divide="ignore"):
        surface = np.where(black, np.inf, network.area * emissivity / (1 - emissivity))
    known = fixed & black  # their J is given
    place = np.full(n, -1)
    own = ~known & ~(shared & black)  # black patches of a node of several have the node's potential
    place[own] = np.arange(own.sum())
    nodes_place = np.full(len(nodes.heat), -1)
    several = np.flatnonzero(size > 1)
    nodes_place[several] = own.sum() + np.arange(len(several))
    place[shared & black] = nodes_place[nodes.node[shared & black]]
    m = int(own.sum()) + len(several)

    # sums of patches that have a potential in common
    have = np.flatnonzero(place >= 0)
    choose = coo_array((np.ones(len(have)), (have, place[have])), shape=(n, m)).tocsr()
    given = np.where(known, emitted, 0.0)
    diagonal = network.whole.copy()
    right = network.exchange @ given + network.escaping * surroundings
    grey = fixed & ~black
    diagonal[grey] += surface[grey]
    right[grey] += surface[grey] * emitted[grey]
    right[alone] += nodes.heat[nodes.node[alone]]
    matrix = choose.T @ (diags_array(diagonal) - network.exchange) @ choose
    right = choose.T @ right
    right[nodes_place[several]] += nodes.heat[several]
    tied = np.flatnonzero(shared & ~black)
    one, other, value = place[tied], nodes_place[nodes.node[tied]], surface[tied]
    ties = coo_array(
        (np.concatenate([value, value, -value, -value]), (np.r_[one, other, one, other], np.r_[one, other, other, one])),
        shape=(m, m),
    )
    matrix = (matrix + ties).tocsr()
    start = (
        np.zeros(m) if guess is None else np.bincount(place[have], guess[have], m) / np.bincount(place[have], minlength=m).clip(1)
    )
    potential = conjugate_gradients(matrix, right, start)

    radiosity = given
    radiosity[have] = potential[place[have]]
    black_emission = np.where(fixed, emitted, 0.0)
    with np.errstate(invalid="ignore"):
        black_emission[alone] = radiosity[alone] + nodes.heat[nodes.node[alone]] / surface[alone]
    black_emission[shared] = potential[nodes_place[nodes.node[shared]]]
    return radiosity, black_emission


def conjugate_gradients(matrix, right: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return x of a symmetric positive definite system; its diagonal is the preconditioner.

    Rows of zeros (patches that no line joins to others) have x = 0. There is a warning where the residual stays too large.
    """
    diagonal = matrix.diagonal()
    inverse = np.divide(1.0, diagonal, out=np.zeros(len(diagonal)), where=diagonal > 0)
    x = np.where(diagonal > 0, start, 0.0)
    residual = right - matrix @ x
    scale = float(right @ (inverse * right))
    if scale == 0:
        return np.zeros(len(right))
    ready = inverse * residual
    direction, product = ready.copy(), float(residual @ ready)
    for _ in range(max(MOST, 4 * len(right))):
        if product <= TOLERANCE**2 * scale:
            break
        image = matrix @ direction
        curvature = float(direction @ image)
        if not curvature > 0:
            break
        step = product / curvature
        x += step * direction
        residual -= step * image
        ready = inverse * residual
        product, before = float(residual @ ready), product
        direction = ready + product / before * direction
    residual = right - matrix @ x
    left = np.sqrt(float(residual @ (inverse * residual)) / scale)
    if left > TOLD:
        warnings.warn(
            f"the exchange of heat was solved to a residual of {left:.1g} only (wanted {TOLD:g}); watts and temperatures are off "
            "by more than their errors say: take fewer patches, or give more surfaces a temperature",
            RadiosityWarning,
            stacklevel=3,
        )
    return x
