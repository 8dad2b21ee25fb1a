"""Referee: exact view factors. One surface emits, all are black, and the share of its power that lands on another is F."""

import radiosity as rd

from .comparison import Value
from .configurations import Configuration, every
from .runs import SEEDS, solved


def measured(case: Configuration, rays: float, seed: int = 0) -> Value:
    """The view factor, extrapolated to smooth bodies where the scene has facets."""
    meshes = [0] if case.facets is None else [case.facets, 2 * case.facets]
    if case.facets is not None and case.facets < 10:  # divisions of a ball, not sides of a circle
        meshes = [case.facets, case.facets + 1]
    shares = []
    # patches of one shape share a low discrepancy sequence, and with it their errors; random numbers do not add up so
    method = rd.Method() if case.flat else rd.Method(numbers="random")
    for i, mesh in enumerate(meshes):
        patches = rd.subdivide(case.build(mesh), cells=1)
        shares.append(solved(patches, rays, method=method, first=1000 * (seed + i)).share(case.receiver))
    if len(shares) == 1:
        return Value.of(case.name, case.exact, shares[0], bound=case.bound)
    fine, coarse = shares[1], shares[0]
    note = f"facets: {(fine.mean() - coarse.mean()) / 3 / case.exact:+.2%} at the finer mesh, extrapolated"
    return Value.of(case.name, case.exact, fine + (fine - coarse) / 3, note, bound=case.bound)


def run(quick: bool):
    """Values, one a configuration."""
    rays = 200_000 * SEEDS if quick else 2_000_000 * SEEDS
    for i, case in enumerate(every()):
        yield measured(case, rays, seed=2 * i)  # other seeds each, since patches of like scenes would fire the same lines
