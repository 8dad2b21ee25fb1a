"""tally -> radiosity, irradiance, errors; save and load"""

from .model import Solution
from .store import load_solution

__all__ = ["Solution", "load_solution"]
