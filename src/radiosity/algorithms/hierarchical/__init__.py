"""Hierarchical radiosity: links between elements as large as an error allows."""

from .parameters import REFINEMENTS, Hierarchical
from .solve import HierarchicalResult, solve_hierarchical

__all__ = ["REFINEMENTS", "Hierarchical", "HierarchicalResult", "solve_hierarchical"]
