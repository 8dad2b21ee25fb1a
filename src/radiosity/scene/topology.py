"""Topology: faces that lie on each other, and edges that belong to one face only."""

from dataclasses import dataclass

import numpy as np

from .model import Scene

WELD = 2e-6  # share of the median vertex's largest coordinate about the centre: vertices that are closer are one


@dataclass(frozen=True, eq=False)
class OpenEdges:
    """Edges of one face only, after vertices were welded.

    Attributes:
        face: (n_open,) int64, the face of each edge.
        length: (n_open,) float64, metres.
        total: the number of all edges.
    """

    face: np.ndarray
    length: np.ndarray
    total: int


def weld(scene: Scene) -> np.ndarray:
    """Return the welded vertex of each corner, (n_faces, 4) int64, -1 where a face has no fourth."""
    used = np.unique(scene.faces[scene.faces >= 0])
    places = scene.vertices[used] - scene.bounds[0]
    # a median, so that an object far away welds no room together; of a flat scene's middle the whole
    size = float(np.median(np.abs(scene.vertices[used] - scene.centre).max(axis=1))) or scene.reach
    cells = np.round(places / (WELD * size))
    # vertices on either side of a rounding border meet on one of two grids, half a step apart
    shifted = np.floor(places / (WELD * size))
    number = _joined(_numbered(cells), _numbered(shifted))
    table = np.full(len(scene.vertices) + 1, -1)
    table[used] = number
    return table[scene.faces]


def _numbered(rows: np.ndarray) -> np.ndarray:
    return np.unique(rows, axis=0, return_inverse=True)[1].ravel()


def _joined(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Classes of points that are equal in either numbering, by propagating the least label."""
    label = np.arange(len(one))
    while True:
        before = label
        for numbering in (one, two):
            least = np.full(numbering.max() + 1, len(one))
            np.minimum.at(least, numbering, label)
            label = least[numbering]
        if (label == before).all():
            return label


def coincident(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pairs of faces with the same corners: first face, second face, and whether both look the same way."""
    corners = np.sort(weld(scene), axis=1)
    order = np.lexsort(corners.T)
    same = (corners[order][1:] == corners[order][:-1]).all(axis=1)
    one, two = order[:-1][same], order[1:][same]
    return np.minimum(one, two), np.maximum(one, two), np.einsum("ij,ij->i", scene.normal[one], scene.normal[two]) > 0


def open_edges(scene: Scene) -> OpenEdges:
    """Edges that belong to one face only. An edge that meets two shorter ones counts as open."""
    corners = weld(scene)
    after = np.roll(corners, -1, axis=1)
    triangle = ~scene.is_quad
    after[triangle, 2] = corners[triangle, 0]
    start, end = corners.ravel(), after.ravel()
    face = np.repeat(np.arange(scene.n_faces), 4)
    real = (start >= 0) & (start != end)
    face, low, high = face[real], np.minimum(start, end)[real], np.maximum(start, end)[real]
    _, first, many = np.unique(np.column_stack([low, high]), axis=0, return_index=True, return_counts=True)
    alone = first[many == 1]
    corner = np.flatnonzero(real)[alone]
    points = scene.vertices[scene.faces.ravel()]
    following = np.roll(scene.faces, -1, axis=1)
    following[triangle, 2] = scene.faces[triangle, 0]
    length = np.linalg.norm(scene.vertices[following.ravel()[corner]] - points[corner], axis=1)
    return OpenEdges(face[alone], length, len(first))
