"""tally -> radiosity, irradiance, errors; save and load"""

from .model import Solution
from .refinement import RefineCheck
from .store import load_solution

__all__ = ["RefineCheck", "Solution", "load_solution"]
