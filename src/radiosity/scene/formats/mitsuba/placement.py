"""Transformations of Mitsuba's shapes, and the front of a shape after them."""

from dataclasses import replace

import numpy as np

from ....errors import SceneError
from ..faces import turned as turned_round
from .node import Node
from .shapes import Geometry, cylinder_axes

UNEVEN = 1e-3  # relative: what rounding of the numbers of a file may make


def transformation(node: Node, label: str) -> np.ndarray:
    """Return ``to_world`` of a shape, (4, 4).

    Raises:
        SceneError: the matrix is not finite, or is a perspective.
    """
    matrix = np.asarray(node.values.get("to_world", np.eye(4)))
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all() or not np.allclose(matrix[3], (0, 0, 0, 1)):
        text = f"{node.place}: the transformation of '{label}' is {matrix.tolist()}"
        raise SceneError(f"{text}; it must be finite and affine")
    return matrix


def check_round(node: Node, matrix: np.ndarray, label: str) -> None:
    """Refuse a sphere that is scaled unevenly, or a cylinder that is not round any more: Mitsuba keeps the shape and
    takes the scale of one axis, with a message in its log.

    Raises:
        SceneError: it is.
    """
    if node.plugin not in ("sphere", "cylinder"):
        return
    axes = matrix[:3, :3] @ (cylinder_axes(node)[1] if node.plugin == "cylinder" else np.eye(3)).T
    lengths = np.linalg.norm(axes, axis=0)
    round_ones = lengths[: 2 if node.plugin == "cylinder" else 3]
    cosines = np.abs(np.triu(axes.T @ axes, 1)).max() / max(lengths.max() ** 2, 1e-300)
    if np.ptp(round_ones) > UNEVEN * round_ones.max() or cosines > UNEVEN:
        scales = ", ".join(f"{length:.4g}" for length in lengths)
        raise SceneError(
            f"{node.place}: the {node.plugin} '{label}' is scaled unevenly or sheared (its axes become {scales} long), which "
            "Mitsuba does not do to this shape; scale it evenly, or take a mesh"
        )


def placed(geometry: Geometry, inner: np.ndarray, outer: np.ndarray, *, flip: bool) -> Geometry:
    """Geometry under its own transformation, then under that of the instance around it.

    Mitsuba takes the side of the shading normal as the front. It transforms normals that are given, and those of an
    instance, so that a mirror leaves the front where it is; it computes others from mirrored corners, which turn round.
    """
    matrix = outer @ inner
    vertices = geometry.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    turned = geometry.own_normals and np.linalg.det(inner[:3, :3]) < 0
    turned ^= bool(np.linalg.det(outer[:3, :3]) < 0)
    faces = geometry.faces if turned == flip else turned_round(geometry.faces)
    return replace(geometry, vertices=vertices, faces=faces)
