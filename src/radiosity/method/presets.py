"""Named algorithms of the literature: each a `Method` and its citation."""

from dataclasses import dataclass, replace

from ..errors import MethodError
from .model import Method


@dataclass(frozen=True)
class Preset:
    """A named algorithm."""

    method: Method
    citation: str


PRESETS = {
    "random-walk": Preset(
        Method(),
        "M. Sbert. Error and complexity of random walk Monte Carlo radiosity. "
        "IEEE Transactions on Visualization and Computer Graphics, 3(1):23-38, March 1997.",
    ),
}


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
    return replace(method, **{axis: value for axis, value in choices.items() if value is not None})
