"""Conjugate gradients on the symmetric form of the equation, through scipy.

With A_i F_ij = A_j F_ji the matrix M = diag(A / rho) - A F is symmetric, and positive definite where rho < 1 and rows of F sum to
1 or less; the equation is M B = A E / rho. Black patches (rho = 0) have B = E, and only light the others.

M. Hestenes and E. Stiefel, "Methods of conjugate gradients for solving linear systems", J. Research of the National Bureau of
Standards 49(6), 1952.
"""

import numpy as np

from ...errors import MethodError
from .model import Solved, System

ASYMMETRY = 1e-9  # of A_i F_ij against A_j F_ji, relative to the largest


def solve(system: System) -> Solved:
    """Solve band after band (each has a matrix of its own), preconditioned by the diagonal.

    Raises:
        MethodError: the form factors are not reciprocal.
    """
    if system.scatter.through is not None:
        raise MethodError(
            "solver 'conjugate-gradients' needs a matrix without what crosses diffusing panes (diffuse_transmittance); take "
            "gauss-seidel"
        )
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import cg

    exchange = (diags_array(system.area) @ system.factors).tocsr()
    asymmetry = abs(exchange - exchange.T).max() if exchange.nnz else 0.0
    if asymmetry > ASYMMETRY * exchange.max():
        raise MethodError(
            f"solver 'conjugate-gradients' needs reciprocal form factors, but A_i F_ij and A_j F_ji differ by up to "
            f"{asymmetry:.3g} m²; restore reciprocity (reciprocal=True, --reciprocal), or take gauss-seidel"
        )
    radiosity, histories = system.emission.copy(), []
    for band in range(system.emission.shape[1]):
        rho = system.scatter.reflectance[:, band]
        shiny = rho > 0
        if not shiny.any():
            continue
        lit = exchange[shiny] @ np.where(shiny, 0.0, system.emission[:, band])
        inner, scale = exchange[shiny][:, shiny], system.area[shiny] / rho[shiny]
        right = scale * system.emission[shiny, band] + lit
        operator, inverse = (diags_array(scale) - inner).tocsr(), diags_array(1 / scale)
        history: list[float] = []

        def told(x, band=band, shiny=shiny, history=history):
            whole = radiosity[:, [band]].copy()
            whole[shiny, 0] = x
            history.append(_relative(system, whole, band))

        x, start = system.emission[shiny, band].copy(), right / scale
        target = system.enough * np.abs(start).max(initial=0.0)
        # scipy's residual is in the 2-norm; so its tolerance is made smaller until the largest entry is small enough
        for factor in (1.0, 1e-2, 1e-4):
            x, _ = cg(
                operator, right, x0=x, rtol=0.0, atol=factor * target * scale.min(), M=inverse, maxiter=len(x) + 8, callback=told
            )
            if history and history[-1] <= system.enough:
                break
        radiosity[shiny, band] = x
        history.append(_relative(system, radiosity[:, [band]], band))
        histories.append(history)
    longest = max(map(len, histories), default=0)
    padded = [h + h[-1:] * (longest - len(h)) if h else [0.0] * longest for h in histories]
    return Solved(radiosity, np.max(padded, axis=0) if padded and longest else np.zeros(0))


def _relative(system: System, radiosity: np.ndarray, band: int) -> float:
    """Return `System.relative` of one band."""
    new = system.emission[:, [band]] + system.scatter.reflectance[:, [band]] * (system.factors @ radiosity)
    largest = np.abs(radiosity).max()
    return float(np.abs(new - radiosity).max() / largest) if largest > 0 else 0.0
