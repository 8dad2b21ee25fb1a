"""Form factors between polygons, as functions of numpy arrays; `matrix.exact` makes the matrix of a scene of them."""

from .exchange import exchange
from .points import from_points

__all__ = ["exchange", "from_points"]
