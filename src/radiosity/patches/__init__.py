"""Patches: cutting the faces of a scene, and hierarchies of patches."""

from .hierarchy import Hierarchy
from .model import Patches
from .subdivide import subdivide

__all__ = ["Hierarchy", "Patches", "subdivide"]
