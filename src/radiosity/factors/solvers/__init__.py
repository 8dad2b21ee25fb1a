"""How is B = E + rho F B solved, once F is there? One file a solver; all keep the history of their convergence."""

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
    """The radiosity of a system by the solver called ``name``.

    Raises:
        MethodError: an unknown name, or form factors that the solver cannot take.
    """
    if name not in SOLVERS:
        raise MethodError(f"solver '{name}' does not exist; known are {', '.join(SOLVERS)}")
    if not np.isfinite(system.factors.data).all():
        raise MethodError("some form factors are not finite numbers")
    return import_module(f".{SOLVERS[name]}", __package__).solve(system)
