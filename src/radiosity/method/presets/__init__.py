"""Named algorithms of the literature: each a `Method`, what it is and when to take it, and its citation."""

from dataclasses import fields, replace

from ...errors import MethodError
from .. import auto
from ..auto import Auto
from ..baseline import USED, Baseline
from ..model import Method
from .baselines import BASELINES
from .citations import Citation
from .global_lines import GLOBAL
from .iterations import ITERATIONS
from .model import Preset
from .walks import WALKS

PRESETS: dict[str, Preset[Method]] = WALKS | ITERATIONS | GLOBAL

__all__ = ["BASELINES", "PRESETS", "Citation", "Preset", "resolve"]


def resolve(method: "str | Method | Baseline | Auto" = auto.NAME, **choices) -> "Method | Baseline | Auto":
    """Return a preset's method, or the given one, with the choices that are not None put into it.

    ``auto`` takes a basis. With other choices it is random-walk with them.

    Raises:
        MethodError: unknown name, unknown value, a choice that it does not have, or a senseless combination.
    """
    known = PRESETS | BASELINES
    if method == auto.NAME or isinstance(method, Auto):
        own = {"basis": method.basis} if isinstance(method, Auto) else {}
        if all(value is None for choice, value in choices.items() if choice != "basis"):
            return Auto(**own | {choice: value for choice, value in choices.items() if value is not None})
        method = auto.FALLBACK
    if isinstance(method, str):
        if method not in known:
            raise MethodError(f"method '{method}' does not exist; known are {', '.join([auto.NAME, *known])}")
        method = known[method].method
    if not isinstance(method, Method | Baseline):
        raise MethodError(f"method is {method!r}; give a name ({', '.join(known)}), a Method or a Baseline")
    given = {choice: value for choice, value in choices.items() if value is not None}
    names = [field.name for field in fields(method)]
    for choice in given:
        if choice not in names:
            raise MethodError(f"'{choice}' is no choice of {method}; it has {', '.join(names)}")
    if isinstance(method, Baseline):
        scheme = given.get("scheme", method.scheme)
        unused = [choice for choice in given if choice != "scheme" and choice not in USED.get(scheme, names)]
        if unused:
            raise MethodError(f"{', '.join(unused)}: not a choice of {scheme}, which has {', '.join(USED[scheme])}")
    if isinstance(method, Method) and any(given.get(c, getattr(method, c)) != getattr(method, c) for c in ("order", "lines")):
        given = {"warm_up": False} | given  # it belongs to the order that was replaced
    if "numbers" in given and isinstance(method, Method):
        given = {"scrambling": None} | given  # it belongs to the numbers that were replaced
    if isinstance(method, Baseline) and given.get("factors", method.factors) != method.factors:
        belonging = ("samples", "resolution", "rotated")  # they belong to the factors that were replaced
        given = {field.name: field.default for field in fields(method) if field.name in belonging} | given
    return replace(method, **given)
