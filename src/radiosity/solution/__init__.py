"""tally -> radiosity, irradiance, errors; save and load"""

from .loading import load_solution
from .model import Solution
from .refinement import RefineCheck

__all__ = ["RefineCheck", "Solution", "load_solution"]
