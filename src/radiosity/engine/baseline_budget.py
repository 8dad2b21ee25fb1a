"""How far a baseline goes, and how finely a scene is cut for it where nobody says."""

from ..errors import MethodError
from ..method import Baseline, Method
from .budget import DONE, Budget

PATCHES = 2_000  # of a scene that is not cut yet: pairs of them still fit everywhere


def chosen_budget(method: Baseline, **asked) -> Budget:
    """The budget that was asked for, or to go on until the method is done.

    Raises:
        MethodError: several budgets, or one that the method cannot keep.
    """
    given = {name: value for name, value in asked.items() if value is not None}
    if "error" in given:
        raise MethodError(f"error: {method} draws no ever larger samples, and cannot go on to a target; refine its own choices")
    if method.scheme == "full-matrix" and {"rays", "seconds"} & set(given):
        raise MethodError(f"{', '.join(given)}: a full matrix is made whole or not at all; its lines follow from the number of "
                          "patches and from resolution or samples: leave it out")  # fmt: skip
    return Budget(**given) if given else Budget(quanta=DONE)


def cut_for(method: "Method | Baseline") -> dict:
    """Arguments of `subdivide` for a scene that is not cut yet."""
    if not isinstance(method, Baseline):
        return {}
    return {"about": PATCHES, "powers_of_two": method.needs_powers_of_two}
