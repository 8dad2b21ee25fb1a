"""What polynomials leave out of light on faces, and what cutting the faces gains, from light that is linear on cells of them.

Constants leave out what the two halves of a face differ by. Polynomials leave out less. And where light is dark in the middle of
a face and alike at both its ends, as behind a lamp, the halves are alike, but the slopes on cells tell. The mean square that is
left out is a quadratic form of the coefficients of the cells, so its noise is known from replicates. What constants leave out
counts a little, too: where light varies much, it has more shape than slopes on cells tell.
"""

from functools import cache

import numpy as np

from .bases import BASES, Basis
from .cells import place
from .halves import Halves, square_of
from .variation import Variation

NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)  # exact up to degree 7: products of polynomials, and Duffy's map
CELLS = BASES["linear"]  # of the light on cells
CONSTANTS = 1 / 8  # of what constants leave out counts as well: in `room` 1/2 and 0 gave larger errors (docs/bases.md)
KINDS = ((2, 2, True), (2, 1, True), (1, 2, True), (2, 2, False))  # columns and rows of a face, and whether it is a parallelogram


def variation(halves: Halves, light: np.ndarray, basis: Basis) -> Variation:
    """Return what cuts of faces gain of the light that polynomials leave out, less noise, in place of `Halves.variation`.

    Args:
        light: (replicates, n_fine, n_bands, 3) coefficients of the irradiance of the fine patches, in `CELLS`.
        basis: of the light on the faces and on their parts.
    """
    constant = halves.variation(light[..., 0])
    columns, rows, quad = halves.fine.columns, halves.fine.rows, halves.coarse.scene.is_quad
    along, across, rest, noise = (np.zeros(len(quad)) for _ in range(4))
    for kind in KINDS:
        faces = np.flatnonzero((columns == kind[0]) & (rows == kind[1]) & (quad == kind[2]))
        if not len(faces):
            continue
        cells = [halves.cells(light[..., k], faces, len(cells_of(*kind))) for k in range(CELLS.size)]
        flat = np.stack(cells, axis=-1).reshape(*cells[0].shape[:3], -1)
        shares = ((flat @ root).reshape(*flat.shape[:2], -1) for root in roots(*kind, basis))
        one, other, (whole, noise[faces]) = (square_of(share) for share in shares)
        if kind[2]:
            first, better = one[0] >= other[0], np.maximum(one[0], other[0])
            second = np.clip(whole - better, 0, np.maximum(better, 0))  # what the other cut gains once this one is made
            along[faces], across[faces] = np.where(first, better, second), np.where(first, second, better)
        else:
            rest[faces] = whole
    pairs = ((along, constant.along), (across, constant.across), (rest, constant.rest), (noise, constant.noise))
    none = np.zeros(len(quad))
    along, across, rest, noise = (one + CONSTANTS * other for one, other in pairs)
    return Variation(along, across, rest, noise, none, none)


@cache
def roots(columns: int, rows: int, quad: bool, basis: Basis) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return roots of what cuts gain of the mean square that is left out on a face, (m, m) float64 each, of m coefficients.

    A gain is the square of the coefficients of all cells, cell by cell, times a root. The cuts are those in halves along the
    first edge and along the second, and that in all parts: cells of parallelograms; of a triangle two cells together, two alone.
    """
    cells = cells_of(columns, rows, quad)
    every = range(len(cells))
    whole = _form(cells, (tuple(every),), quad, basis)
    if not quad:
        gain = _root(whole - _form(cells, ((0, 1), (2,), (3,)), quad, basis))
        return np.zeros_like(gain), np.zeros_like(gain), gain
    along = tuple(tuple(i for i in every if cells[i][0] == column) for column in range(columns))
    across = tuple(tuple(i for i in every if cells[i][1] == row) for row in range(rows))
    alone = tuple((i,) for i in every)
    one, other, all_parts = (_root(whole - _form(cells, parts, quad, basis)) for parts in (along, across, alone))
    return one, other, all_parts


def cells_of(columns: int, rows: int, quad: bool) -> list[tuple[int, int, bool]]:
    """Return column, row, and whether it is inverted, of each cell of a face, in the order of patches."""
    found = place(np.arange(columns * rows), np.array(columns), np.array(quad))
    return list(zip(*(np.broadcast_to(x, columns * rows).tolist() for x in found), strict=True))


def _form(cells: list, parts: tuple, quad: bool, basis: Basis) -> np.ndarray:
    """Return the quadratic form of the mean square that polynomials on parts leave out of light on cells, (m, m) float64.

    Args:
        parts: the cells of each part, on which there is one polynomial.
    """
    a, b = (x.ravel() for x in np.meshgrid((NODES + 1) / 2, (NODES + 1) / 2, indexing="ij"))
    weight = np.outer(WEIGHTS, WEIGHTS).ravel() / 4
    a, weight = (a, weight) if quad else (a * (1 - b), weight * 2 * (1 - b))  # Duffy's map of the square to the triangle
    n, size = len(a), CELLS.size
    values, places, owner = np.zeros((len(cells) * n, len(cells) * size)), [], np.repeat(np.arange(len(cells)), n)
    for i, (column, row, inverted) in enumerate(cells):
        values[i * n : (i + 1) * n, i * size : (i + 1) * size] = CELLS.at(a, b, np.array(quad))
        places.append((column + (1 - a if inverted else a), row + (1 - b if inverted else b)))
    root = np.sqrt(np.tile(weight, len(cells)) / len(cells))
    values = values * root[:, None]
    x, y = (np.concatenate(one) for one in zip(*places, strict=True))
    left = values.copy()
    for part in parts:
        some = np.isin(owner, part)
        fitted, _ = np.linalg.qr(np.stack([x[some] ** p * y[some] ** q for p, q in basis.powers], axis=1) * root[some, None])
        left[some] -= fitted @ (fitted.T @ values[some])
    return left.T @ left


def _root(form: np.ndarray) -> np.ndarray:
    values, vectors = np.linalg.eigh(form)
    return vectors * np.sqrt(np.maximum(values, 0))
