"""A quantity that varies over a face: texture images and corner colours that multiply a base value."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class Paint:
    """Multiplies a face's base value at a point of the face.

    Attributes:
        images: linear (not gamma encoded) images, each (height, width, n_bands) float32; row 0 is the top
            (v = 1), as in image files. Repeated outside the unit square.
        image: (n_faces,) int32, which image; -1 where there is none.
        uv: (n_faces, 4, 2) float32, texture coordinates of the corners (unused where image is -1).
        color: (n_faces, 4, n_bands) float32, corner colours; 1 where there are none.
        limit: product of base value and paint is brought down to this (reflectance), or infinity.
    """

    images: tuple[np.ndarray, ...]
    image: np.ndarray
    uv: np.ndarray
    color: np.ndarray
    limit: float = np.inf

    @cached_property
    def painted(self) -> np.ndarray:
        """(n_faces,) bool, faces with an image or colours; the base value of others stays as it is."""
        return (self.image >= 0) | (self.color != 1).any(axis=(1, 2))

    def factor(self, face: np.ndarray, u: np.ndarray, v: np.ndarray, is_quad: np.ndarray) -> np.ndarray:
        """The multiplier, (m, n_bands), at face coordinates (u, v) of m points.

        A face's second edge ends in its corner 3 where it is a parallelogram, in corner 2 where it is a triangle.
        """
        result = _between(self.color[face], is_quad, u, v).astype(np.float64)
        if not self.images:
            return result
        at = _between(self.uv[face], is_quad, u, v)
        which = self.image[face]
        for index, image in enumerate(self.images):
            rows = np.flatnonzero(which == index)
            result[rows] *= _look_up(image, at[rows])
        return result

    def take(self, faces: np.ndarray) -> "Paint":
        """The paint of a choice of faces."""
        return Paint(self.images, self.image[faces], self.uv[faces], self.color[faces], self.limit)


def _between(corners: np.ndarray, is_quad: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Corner values (m, 4, k) at (u, v): linear in a triangle, bilinear in a parallelogram."""
    one, two, three, four = (corners[:, i] for i in range(4))
    u, v, quad = u[:, None], v[:, None], is_quad[:, None]
    return one + (two - one) * u + (np.where(quad, four, three) - one) * v + np.where(quad, one - two + three - four, 0) * (u * v)


def _look_up(image: np.ndarray, uv: np.ndarray) -> np.ndarray:
    """Bilinear look-up with repetition; (m, 2) to (m, n_bands)."""
    height, width = image.shape[:2]
    x = (uv[:, 0] % 1.0) * width - 0.5
    y = (1.0 - uv[:, 1] % 1.0) * height - 0.5
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    fx, fy = (x - left)[:, None], (y - top)[:, None]
    columns, rows = (left % width, (left + 1) % width), (top % height, (top + 1) % height)
    upper = image[rows[0], columns[0]] * (1 - fx) + image[rows[0], columns[1]] * fx
    lower = image[rows[1], columns[0]] * (1 - fx) + image[rows[1], columns[1]] * fx
    return upper * (1 - fy) + lower * fy
