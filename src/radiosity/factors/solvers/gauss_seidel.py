"""Gauss-Seidel iterations: patch after patch gathers from the newest values.

The first radiosity programs did the same (M. Cohen and D. Greenberg, "The hemi-cube", SIGGRAPH 1985).
"""

import numpy as np

from .model import Solved, System


def solve(system: System) -> Solved:
    """Set B_i <- E_i + rho_i sum_j F_ij B_j for one i after the other, all bands of a patch together."""
    factors, emission, scatter = system.factors, system.emission, system.scatter
    reflectance, through, other = scatter.reflectance, scatter.through, scatter.other
    radiosity, history = emission.copy(), []
    begin, columns, values = factors.indptr, factors.indices, factors.data
    reflects = np.flatnonzero(scatter.albedo.any(axis=1))
    for _ in range(system.most_steps):
        for i in reflects:
            row = slice(begin[i], begin[i + 1])
            radiosity[i] = emission[i] + reflectance[i] * (values[row] @ radiosity[columns[row]])
            if through is not None and other is not None and through[i].any():
                row = slice(begin[other[i]], begin[other[i] + 1])
                radiosity[i] += through[i] * (values[row] @ radiosity[columns[row]])
        history.append(system.relative(system.residual(radiosity), radiosity))
        if history[-1] <= system.enough:
            break
    return Solved(radiosity, np.array(history))
