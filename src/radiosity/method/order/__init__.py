"""Which line is fired next? Each module runs the engine until no patch owes a line."""

from importlib import import_module

ORDERS = {
    "breadth-first": "breadth_first",
    "depth-first": "depth_first",
}


def run(name: str, engine, progress) -> None:
    """Fire every line owed in the order called ``name``."""
    import_module(f".{ORDERS[name]}", __package__).run(engine, progress)
