"""Orders of the firing engine: each module fires until no patch owes a line."""

from importlib import import_module

FIRED = {
    "depth-first": "depth_first",
    "breadth-first": "breadth_first",
    "staged": "breadth_first",
    "well-distributed": "well_distributed",
}


def run(name: str, engine, progress) -> None:
    """Fire every line owed in the order called ``name``."""
    import_module(f".{FIRED[name]}", __package__).run(engine, progress)
