"""Light from faces that are narrow for the size of the scene: lines begin a little inside edges, and leave much of them out."""

import warnings

import numpy as np
import pytest

import radiosity as rd
from validation.closed_forms.rectangles import parallel

TOLD = r"faces are so narrow, for the size of the scene, .*'low: \d+%'.*the light that they send may be as far off"


def strips(length: float, stray: float | None = None) -> rd.Patches:
    """Two black strips of width 1, one above the other; the lower one emits. A black strip of 0.1 mm may lie beside them."""
    corners = [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, length), (0, length))]
    faces, surface, names = [[0, 1, 2, 3], [4, 7, 6, 5]], [0, 1], ["low", "high"]
    if stray is not None:
        corners += [[stray + x, y, 0] for x, y in ((0, 0), (20, 0), (20, 1e-4), (0, 1e-4))]
        faces, surface, names = [*faces, [8, 9, 10, 11]], [*surface, 2], [*names, "stray"]
    scene = rd.Scene.from_arrays(corners, faces, 0.0, [1.0, *[0.0] * (len(faces) - 1)], surface=surface, names=names)
    return rd.subdivide(scene, cells=1)


@pytest.mark.parametrize("method", ["random-walk", "gather"])
def test_light_of_a_long_strip_is_off_and_told(method):
    """Of 10 km: 0.417 reaches the other for 0.414, which is 18 standard errors; of 100 m it is right, and nothing is told."""
    with pytest.warns(rd.RadiosityWarning, match=TOLD):
        found = rd.solve(strips(1e4), method, rays=100_000)
    exact = parallel(1.0, 1e4) / 1e4
    assert found.irradiance[1, 0] > exact + 5 * found.irradiance_standard_error[1, 0]
    found = rd.solve(strips(100.0), method, rays=100_000)
    assert abs(found.irradiance[1, 0] - parallel(1.0, 100.0) / 100) < 5 * found.irradiance_standard_error[1, 0]


def test_other_ways_of_local_lines_are_told_and_exact_factors_are_not():
    patches = strips(1e4)
    with pytest.warns(rd.RadiosityWarning, match=TOLD):
        rd.solve(patches, "full-matrix", factors="lines", replicates=2)
    lines = rd.trace_lines(patches, rays=10_000)
    with pytest.warns(rd.RadiosityWarning, match=TOLD):
        lines.solve()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        exact = rd.solve(patches, "full-matrix")
    assert exact.irradiance[1, 0] == pytest.approx(parallel(1.0, 1e4) / 1e4, rel=1e-4)


def test_what_sends_next_to_nothing_is_not_told():
    """A black strip of 0.1 mm and 20 m: lines begin on part of it alone, and it neither emits nor reflects."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = rd.solve(strips(10.0, stray=100.0), "random-walk", rays=20_000)
    assert np.isfinite(found.irradiance[:2]).all()
