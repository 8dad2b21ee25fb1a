"""Jacobi iterations: each one sends all light once more (gathering form)."""

import numpy as np

from .model import Solved, System


def solve(system: System) -> Solved:
    """Set B <- E + rho F B until the change is small enough."""
    radiosity, history = system.emission.copy(), []
    for _ in range(system.most_steps):
        change = system.residual(radiosity)
        radiosity += change
        history.append(system.relative(change, radiosity))
        # after a change r the next one is at most contraction * r
        if history[-1] * system.contraction <= system.enough:
            break
    return Solved(radiosity, np.array(history))
