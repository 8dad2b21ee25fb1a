"""What polynomials leave out on faces, from slopes on their cells, and meshes that follow it."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.patches.bases import BASES
from radiosity.patches.left_out import CELLS, KINDS, cells_of, roots
from radiosity.scene.shapes import quad


def coefficients(field, columns: int, rows: int, quad: bool) -> np.ndarray:
    """Those of a function of face coordinates on the cells, (cells * 3,), by a fine rule."""
    u, v = (x.ravel() for x in np.meshgrid(*2 * [(np.arange(200) + 0.5) / 200]))
    if not quad:
        u, v = u[u + v < 1], v[u + v < 1]
    found, functions = [], CELLS.at(u, v, np.array(quad))
    for column, row, inverted in cells_of(columns, rows, quad):
        x, y = (1 - u, 1 - v) if inverted else (u, v)
        found.append((functions * field((column + x) / columns, (row + y) / rows)[:, None]).mean(axis=0))
    return np.concatenate(found)


def gains(field, kind, basis: str) -> list[float]:
    """What halves along, halves across, and all parts gain."""
    light = coefficients(field, *kind)
    return [float(((light @ root) ** 2).sum()) for root in roots(*kind, BASES[basis])]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("basis", ["linear", "quadratic"])
def test_a_linear_field_needs_no_cut(kind, basis):
    assert gains(lambda u, v: 2 + u - 3 * v, kind, basis) == pytest.approx([0, 0, 0], abs=1e-3)


def test_light_that_is_alike_at_both_ends_is_seen():
    """|2u - 1| differs from its mean by 1/12 in the mean square, which halves along u know, and halves across do not."""
    assert gains(lambda u, v: np.abs(2 * u - 1), (2, 1, True), "linear") == pytest.approx([1 / 12, 0, 1 / 12], rel=1e-3, abs=1e-6)
    assert gains(lambda u, v: np.abs(2 * u - 1), (2, 2, True), "linear") == pytest.approx([1 / 12, 0, 1 / 12], rel=1e-3, abs=1e-6)
    assert gains(lambda u, v: np.abs(2 * v - 1), (2, 2, True), "linear") == pytest.approx([0, 1 / 12, 1 / 12], rel=1e-3, abs=1e-6)
    # the best parabola takes 15/16 of it: the integral of |x| (3 x² - 1) sqrt(5) / 2 over [0, 1] is sqrt(5) / 8
    assert gains(lambda u, v: np.abs(2 * u - 1), (2, 1, True), "quadratic")[0] == pytest.approx(1 / 12 - 5 / 64, rel=2e-2)


def test_meshes_for_a_basis_cut_where_halves_are_alike():
    """A floor between two lamps: bright at both ends, dark between them. Halves of it are alike; quarters and slopes tell."""
    floor = quad((0, 0, 0), (2, 0, 0), (0, 1, 0))
    lamps = [quad((x, 0.4, 0.4), (0, 0.2, 0), (0.2, 0, 0)) for x in (0.15, 1.65)]
    scene = rd.Scene.from_arrays(np.concatenate([floor, *lamps]), np.arange(12).reshape(3, 4), 0.5, [0.0, 1.0, 1.0])
    for basis in BASES:
        patches = rd.adapt(scene, 12, basis=basis, seed=1)
        assert np.ptp(patches.corners[patches.normal[:, 2] > 0][:, :, 0], axis=1).max() < 1.01


def test_an_unknown_basis_is_refused():
    with pytest.raises(rd.MethodError, match="basis 'cubic' is not known; known are constant, linear, quadratic"):
        rd.adapt(rd.load_scene("room"), 60, basis="cubic")
