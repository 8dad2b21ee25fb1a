"""Orders of the firing engine: a new one is one new file and one line in the table."""

from importlib import import_module

from ...base import Swept
from ..counters import FiringCounters
from .base import AbstractOrder

FIRED = {
    "depth-first": "depth_first:DepthFirst",
    "breadth-first": "breadth_first:BreadthFirst",
    "staged": "breadth_first:BreadthFirst",
    "well-distributed": "well_distributed:WellDistributed",
}

__all__ = ["FIRED", "AbstractOrder", "fire_all"]


def fire_all(name: str, counters: FiringCounters, swept: Swept) -> None:
    """Fire every line that is due, in the order ``name``; elsewhere in whole wavefronts, to the same integers."""
    name = name if counters.firer is None else "breadth-first"
    module, order = FIRED[name].split(":")
    getattr(import_module(f".{module}", __package__), order)().run(counters, swept)
