"""A quantity that varies over a face: texture images and corner colours that multiply a base value."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from .sampler import DEFAULT_SAMPLER, Sampler, fold


@dataclass(frozen=True, eq=False)
class Paint:
    """A factor of a face's base value at each point of the face.

    Attributes:
        images: linear (not gamma encoded) images, each (height, width, n_bands) float32; row 0 is the top
            (v = 1), as in image files.
        image: (n_faces,) int32, the number of the image; -1 where there is none.
        uv: (n_faces, 4, 2) float32, texture coordinates of the corners (unused where image is -1).
        color: (n_faces, 4, n_bands) float32, corner colours; 1 where there are none.
        limit: the largest product of base value and paint (reflectance), or infinity. Larger products are brought down to it, at
            each texel, and where there is no image at each point.
        samplers: one for each image. If empty, all images repeat, and are linear between the centres of texels.
    """

    images: tuple[np.ndarray, ...]
    image: np.ndarray
    uv: np.ndarray
    color: np.ndarray
    limit: float = np.inf
    samplers: tuple[Sampler, ...] = ()

    def sampler(self, index: int) -> Sampler:
        """The sampler of an image."""
        return self.samplers[index] if self.samplers else DEFAULT_SAMPLER

    @cached_property
    def painted(self) -> np.ndarray:
        """True where a face has an image or colours, (n_faces,) bool; the base value of others stays as it is."""
        return (self.image >= 0) | (self.color != 1).any(axis=(1, 2))

    def factor(self, face: np.ndarray, u: np.ndarray, v: np.ndarray, is_quad: np.ndarray) -> np.ndarray:
        """The multiplier, (m, n_bands), at face coordinates (u, v) of m points; without the limit.

        A face's second edge ends in its corner 3 where it is a parallelogram, in corner 2 where it is a triangle.
        """
        result = between(self.color[face], is_quad, u, v).astype(np.float64)
        if not self.images:
            return result
        at = between(self.uv[face].astype(np.float64), is_quad, u, v)
        which = self.image[face]
        for index, image in enumerate(self.images):
            rows = np.flatnonzero(which == index)
            result[rows] *= look_up(image, self.sampler(index), at[rows])
        return result

    def in_bands(self, n_bands: int) -> "Paint":
        """The paint of so many bands: those of a grey one are equal."""
        images = tuple(np.broadcast_to(one, (*one.shape[:2], n_bands)) for one in self.images)
        return replace(self, images=images, color=np.broadcast_to(self.color, (*self.color.shape[:2], n_bands)))

    def take(self, faces: np.ndarray) -> "Paint":
        """The paint of a choice of faces."""
        return replace(self, image=self.image[faces], uv=self.uv[faces], color=self.color[faces])


def between(corners: np.ndarray, is_quad: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Corner values (m, 4, k) at (u, v): linear in a triangle, bilinear in a parallelogram."""
    one, two, three, four = (corners[:, i] for i in range(4))
    u, v, quad = u[:, None], v[:, None], is_quad[:, None]
    return one + (two - one) * u + (np.where(quad, four, three) - one) * v + np.where(quad, one - two + three - four, 0) * (u * v)


def look_up(image: np.ndarray, sampler: Sampler, uv: np.ndarray) -> np.ndarray:
    """The image at texture coordinates, (m, 2) to (m, n_bands) float64."""
    height, width = image.shape[:2]
    x, y = uv[:, 0] * width, (1.0 - uv[:, 1]) * height
    if sampler.filter == "nearest":
        return image[_texels(y, height, sampler.wrap[1]), _texels(x, width, sampler.wrap[0])].astype(np.float64)
    x, y = x - 0.5, y - 0.5
    fx, fy = (x - np.floor(x))[:, None], (y - np.floor(y))[:, None]
    columns, rows = (
        [_texels(at + step, count, wrap) for step in (0, 1)]
        for at, count, wrap in ((x, width, sampler.wrap[0]), (y, height, sampler.wrap[1]))
    )
    upper = image[rows[0], columns[0]] * (1 - fx) + image[rows[0], columns[1]] * fx
    lower = image[rows[1], columns[0]] * (1 - fx) + image[rows[1], columns[1]] * fx
    return upper * (1 - fy) + lower * fy


def _texels(at: np.ndarray, count: int, wrap: str) -> np.ndarray:
    """Return the texels that hold places on an axis, at any distance."""
    return fold(np.floor(at), count, wrap).astype(np.int64)
