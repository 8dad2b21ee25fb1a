"""Named algorithms of the literature: each a `Method`, what it is and when to take it, and its citation."""

from dataclasses import replace

from ...errors import MethodError
from ..model import Method
from .citations import Citation
from .global_lines import GLOBAL
from .iterations import ITERATIONS
from .model import Preset
from .walks import WALKS

PRESETS: dict[str, Preset] = WALKS | ITERATIONS | GLOBAL

__all__ = ["PRESETS", "Citation", "Preset", "resolve"]


def resolve(method: "str | Method" = "random-walk", **choices) -> Method:
    """A preset's method, or one given as such, with the choices that are not None put in its place.

    Raises:
        MethodError: unknown name, unknown value, or a senseless combination.
    """
    if isinstance(method, str):
        if method not in PRESETS:
            raise MethodError(f"method '{method}' does not exist; known are {', '.join(PRESETS)}")
        method = PRESETS[method].method
    if not isinstance(method, Method):
        raise MethodError(f"method is {method!r}; give a name ({', '.join(PRESETS)}) or a Method")
    given = {axis: value for axis, value in choices.items() if value is not None}
    if given.get("order", method.order) != method.order and "warm_up" not in given:
        given["warm_up"] = False  # belongs to the order that was replaced
    return replace(method, **given)
