"""Southwell relaxation: the patch with the most unshot power shoots it to all others.

S. Gortler, M. Cohen and P. Slusallek, "Radiosity and relaxation methods", IEEE Computer Graphics and Applications 14(6), 1994,
show that progressive refinement is this.
"""

import numpy as np

from .model import Solved, System


def solve(system: System) -> Solved:
    """Solve by residuals r, which are kept: B_i += r_i, r_j += rho_j F_ji r_i, r_i = 0 (bands of a patch together)."""
    columns = system.factors.tocsc()  # shooting needs what sees patch i, not what it sees
    begin, rows, values = columns.indptr, columns.indices, columns.data
    area, scatter = system.area, system.scatter
    radiosity, residual = np.zeros_like(system.emission), system.emission.copy()
    n, history = len(area), []
    unshot = area * residual.sum(axis=1)
    for _ in range(system.most_steps):
        for _ in range(n):
            i = int(np.argmax(unshot))
            shot = residual[i].copy()
            if not shot.any():
                break
            radiosity[i] += shot
            residual[i], unshot[i] = 0.0, 0.0
            seers = rows[begin[i] : begin[i + 1]]
            arriving = values[begin[i] : begin[i + 1], None] * shot
            residual[seers] += scatter.reflectance[seers] * arriving
            if scatter.through is not None and scatter.other is not None:
                residual[scatter.other[seers]] += scatter.through[seers] * arriving
                seers = np.union1d(seers, scatter.other[seers])
            unshot[seers] = area[seers] * residual[seers].sum(axis=1)
        history.append(system.relative(residual, radiosity + residual))
        if history[-1] <= system.enough:
            break
    return Solved(radiosity + residual, np.array(history))
