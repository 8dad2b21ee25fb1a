"""Solvers of B = E + rho F B for a known F. There is one file a solver; all keep the history of their convergence."""

from importlib import import_module

import numpy as np

from ...errors import MethodError
from .model import Solved, System

__all__ = ["SOLVERS", "Solved", "System", "solve"]

SOLVERS = {  # the file of each; what they are is told by `method.schemes`
    "jacobi": "jacobi",
    "gauss-seidel": "gauss_seidel",
    "southwell": "southwell",
    "conjugate-gradients": "conjugate_gradients",
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
    return import_module(f".{SOLVERS[name]}", __package__).solve(system)
