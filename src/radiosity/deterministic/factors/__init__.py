"""Form factors between polygons, as functions of numpy arrays."""

from .exchange import exchange
from .points import from_points

__all__ = ["exchange", "from_points"]
