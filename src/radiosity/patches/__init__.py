"""Scene -> Patches"""

from .model import Patches
from .subdivide import subdivide

__all__ = ["Patches", "subdivide"]
