"""Edges of shadows: the lines of faces at which the light of a strong lamp ends, and what a mesh gains by cuts along them."""

from .lines import shadow_lines

__all__ = ["shadow_lines"]
