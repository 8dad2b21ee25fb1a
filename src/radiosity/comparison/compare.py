"""`compare`: the differences of two solutions, and whether their errors explain them."""

import numpy as np

from ..errors import MethodError
from ..solution import intervals
from ..solution.model import Solution
from .pairing import Places, check_comparable, other_light, paired_rows, places
from .result import OF, Comparison, PatchDifferences
from .rows import rows_of
from .significance import Test, welch

LEAST = 8 * intervals.FEW  # hits: with fewer, values are too skewed for a test of thousands at once


def compare(
    a: Solution,
    b: Solution,
    *,
    quantity: str = "irradiance",
    within: float | None = None,
    of: str = "patches",
    alpha: float = 0.05,
    reference: bool = False,
    names: tuple[str, str] | None = None,
) -> Comparison:
    """Compare two solutions: by surface and side, and by patch where their faces are the same.

    Where faces are the same and cut otherwise, values are compared wherever a patch of one overlaps a patch of the other; each
    overlap counts by its area.

    Args:
        a, b: the solutions. Relative differences are relative to the second.
        quantity: "irradiance" or "radiosity".
        within: the largest relative difference that is allowed, such as 0.02. Default: the errors decide.
        of: what ``within`` is of: "patches" (the area-weighted RMS of differences) or "surfaces" (the largest difference of the
            mean over a surface's side).
        alpha: the probability with which two solutions that agree are called different.
        reference: the second solution is exact, as far as this comparison goes: its errors count as zero, known or not.
        names: of the solutions, for messages. Default: "first" and "second".

    Returns:
        A `Comparison`. Its ``agrees`` is None where nothing can be told, since no error is known.

    Raises:
        SceneError: the solutions have other bands or units, no surface in common, or no results.
        MethodError: another quantity, or a value out of range.

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=2)
        >>> one = rd.solve(patches, rays=20_000)
        >>> rd.compare(one, one, within=0.01).agrees
        True
    """
    _check_values(a, b, quantity, within, of, alpha)
    check_comparable(a, b)
    place = places(a, b)
    replicates = (a.replicates, None if reference else b.replicates)
    first, second, notes = paired_rows(a, b)
    notes += other_light(a.patches.scene, b.patches.scene) if place is not None else ["the faces differ: surfaces are compared"]
    if place is not None and not place.equal:
        notes.append("the patches differ: differences where they overlap hold the discretisation of both, which errors do not")
    if not reference and a.provenance["seed"] == b.provenance["seed"]:
        notes.append("both runs have the same seed: where they share lines, their difference is smaller than the errors say")
    rows = rows_of(a, b, (first, second), quantity, replicates, LEAST)
    by_patch = None if place is None else _by_patch(a, b, place, quantity, replicates)
    unit = a.irradiance_unit if quantity == "irradiance" else a.unit
    return Comparison(names or ("first", "second"), quantity, unit, a.bands, rows, by_patch, alpha, within, of, tuple(notes))


def _by_patch(a: Solution, b: Solution, place: Places, quantity: str, replicates) -> PatchDifferences:
    each = ((a, place.first), (b, place.second))
    key = "irradiance_standard_error" if quantity == "irradiance" else "standard_error"
    values = np.stack([getattr(one, quantity)[patch] for one, patch in each])
    errors = np.stack([getattr(one, key)[patch] for one, patch in each])
    for which, count in enumerate(replicates):
        if count is None:
            errors[which] = 0.0
    counted = ~np.any([one.sides.left_out[patch] for one, patch in each], axis=0)
    tested = counted & np.all([_enough(one)[patch] for one, patch in each], axis=0)
    test = welch(values[0] - values[1], errors, replicates)
    test = Test(*(np.where(tested[:, None], value, np.nan) for value in (test.score, test.chance)))
    return PatchDifferences(place.patches, values, errors, counted, tested, test, place.equal)


def _enough(solution: Solution) -> np.ndarray:
    """Which patches enough lines hit for a test, (n_patches,) bool."""
    return np.ones(len(solution.patches), bool) if solution.by_baseline else solution.arrivals >= LEAST


def _check_values(a, b, quantity: str, within: float | None, of: str, alpha: float) -> None:
    for name, one in (("first", a), ("second", b)):
        if not isinstance(one, Solution):
            raise MethodError(f"compare takes solutions; the {name} is {type(one).__name__}: load it by load_solution")
    intervals.check(quantity)
    if within is not None and not 0 <= within < np.inf:
        raise MethodError(f"within is {within!r}; it must be 0 or more, such as 0.02")
    if of not in OF:
        raise MethodError(f"of is {of!r}; known are {', '.join(OF)}")
    if not 0 < alpha < 1:
        raise MethodError(f"alpha is {alpha!r}; it must be above 0 and strictly below 1, such as 0.05")
