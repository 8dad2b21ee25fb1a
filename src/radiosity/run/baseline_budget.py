"""The budget of a baseline, the default patches for it, and what its energy balance says about its form factors."""

import warnings

from ..algorithms.baseline_state import AbstractSolvedState
from ..algorithms.progressive.state import ProgressiveState
from ..errors import MethodError, RadiosityWarning
from ..method import Auto, Baseline, Method
from .budget import DONE, Budget

MISSING = 0.01  # of the emitted power: a larger error of the energy balance is told
PATCHES = 2_000  # of a scene that is not cut yet: pairs of so many still fit in any memory


def chosen_budget(method: Baseline, **asked) -> Budget:
    """Return the budget that was asked for, or one that goes on until the method is done.

    Raises:
        MethodError: there are several budgets, or one that the method cannot keep.
    """
    given = {name: value for name, value in asked.items() if value is not None}
    if "error" in given:
        raise MethodError(f"error: {method} draws no ever larger samples, and cannot go on to a target; refine its own choices")
    if method.scheme == "full-matrix" and {"rays", "seconds"} & set(given):
        raise MethodError(
            f"{', '.join(given)}: a full matrix is made whole or not at all; its lines follow from the number of "
            "patches and from resolution or samples: leave it out"
        )
    return Budget(**given) if given else Budget(quanta=DONE)


def cut_for(method: "Method | Baseline | Auto") -> dict:
    """Return arguments of `subdivide` for a scene that is not cut yet."""
    if not isinstance(method, Baseline):
        return {"powers_of_two": True} if method.needs_powers_of_two else {}
    return {"about": PATCHES, "powers_of_two": method.needs_powers_of_two}


def warn_of_missing(method: Baseline, books: tuple[dict, ...], state: AbstractSolvedState, *, cut_short: bool) -> None:
    """Tell of power that a run which ended before its method was done did not carry, and of that which form factors lose or make,
    or that had to be cut (`algorithms.progressive`).

    Args:
        cut_short: the run ended by time or lines, and nobody asked for so many steps.
    """
    off = max((abs(book["rounding"]) / book["emitted"] for book in books if book["emitted"] > 0), default=0.0)
    off = max(off, state.cut if isinstance(state, ProgressiveState) else 0.0)
    done = state.solved is not None and state.solved.done
    if cut_short and not done and (off > MISSING or method.scheme == "hierarchical"):
        coarse = ", and links are coarser than epsilon asks for" if method.scheme == "hierarchical" else ""
        warnings.warn(
            f"the run ended before {method.scheme} radiosity was done: {off:.1%} of the emitted power is out of balance{coarse}; "
            "give it more time, or go on from the solution (resume)",
            RadiosityWarning,
            stacklevel=6,
        )
    if off > MISSING and done:
        way_out = "factors polygons (a hemicube is one point)" if method.factors == "hemicube" else "more samples"
        warnings.warn(
            f"{off:.1%} of the emitted power is out of balance: form factors are inaccurate by this much; "
            f"take {way_out}, or smaller patches",
            RadiosityWarning,
            stacklevel=6,
        )
