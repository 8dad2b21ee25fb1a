"""Solvers of B = E + rho F B for a known F. There is one file a solver; all keep the history of their convergence."""

from importlib import import_module

import numpy as np

from ...errors import MethodError
from .model import Solved, System

__all__ = ["SOLVERS", "Solved", "System", "solve"]

SOLVERS = {
    "jacobi": "all patches at once from the last iterate",
    "gauss-seidel": "patch after patch, from the newest values",
    "southwell": "always the patch with the most unshot power, which is shot to all others",
    "conjugate-gradients": "conjugate gradients on the symmetric form of the equation; reciprocal form factors only",
}


def solve(name: str, system: System) -> Solved:
    """Return the radiosity of a system by the solver called ``name``.

    Raises:
        MethodError: the name is unknown, or the solver cannot take the form factors.
    """
    if name not in SOLVERS:
        raise MethodError(f"solver '{name}' does not exist; known are {', '.join(SOLVERS)}")
    if not np.isfinite(system.factors.data).all():
        raise MethodError("some form factors are not finite numbers")
    return import_module(f".{name.replace('-', '_')}", __package__).solve(system)
