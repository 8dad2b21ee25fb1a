"""Small images, and the mean of what an image and corner colours make of a triangle, from many points."""

from pathlib import Path

import numpy as np

POINTS = 10_000  # in a triangle


def save_png(path: Path, pixels: np.ndarray) -> None:
    from PIL import Image

    Image.fromarray(np.asarray(pixels, np.uint8)).save(path)


def square(count: int) -> np.ndarray:
    """(count, 2) points that fill the unit square evenly, along no axis (M. Roberts's sequence R2)."""
    return (0.5 + np.arange(count)[:, None] * (0.7548776662466927, 0.5698402909980532)) % 1


def spots(count: int) -> np.ndarray:
    """(count, 3) weights of a triangle's corners at points that fill it evenly."""
    ab = square(count)
    ab = np.where(ab.sum(axis=1, keepdims=True) > 1, 1 - ab, ab)
    return np.column_stack([1 - ab.sum(axis=1), ab])


def linear(srgb) -> np.ndarray:
    """Linear values of sRGB ones, 0 to 1 (IEC 61966-2-1)."""
    srgb = np.asarray(srgb, float)
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def means(uv, image, *, colors=None, wrap=("repeat", "repeat"), nearest=False) -> np.ndarray:
    """(m, 3) means over triangles of an image times corner colours.

    Args:
        uv: (m, 3, 2) coordinates of the corners, v upwards from the lower edge of the image; None: no image.
        image: (height, width, 3) linear, row 0 on top.
        colors: (m, 3, 3) linear corner colours.
        wrap: of u and of v: repeat, mirror or clamp.
    """
    weights = spots(POINTS)
    found = []
    for number in range(len(uv if uv is not None else colors)):
        values = np.ones((len(weights), 3))
        if uv is not None:
            values = look_up(image, weights @ uv[number], wrap, nearest)
        if colors is not None:
            values = values * (weights @ colors[number])
        found.append(values.mean(axis=0))
    return np.array(found)


def look_up(image: np.ndarray, uv: np.ndarray, wrap, nearest: bool) -> np.ndarray:
    """(n, 3) values at (n, 2) coordinates."""
    height, width = image.shape[:2]
    x, y = uv[:, 0] * width, (1 - uv[:, 1]) * height
    if nearest:
        return image[_texel(np.floor(y), height, wrap[1]), _texel(np.floor(x), width, wrap[0])]
    x, y = x - 0.5, y - 0.5
    left, top = np.floor(x), np.floor(y)
    fx, fy = (x - left)[:, None], (y - top)[:, None]
    rows = [_texel(top + i, height, wrap[1]) for i in (0, 1)]
    columns = [_texel(left + i, width, wrap[0]) for i in (0, 1)]
    upper = image[rows[0], columns[0]] * (1 - fx) + image[rows[0], columns[1]] * fx
    lower = image[rows[1], columns[0]] * (1 - fx) + image[rows[1], columns[1]] * fx
    return upper * (1 - fy) + lower * fy


def _texel(index: np.ndarray, size: int, wrap: str) -> np.ndarray:
    index = index.astype(int)
    if wrap == "clamp":
        return np.clip(index, 0, size - 1)
    if wrap == "mirror":
        index = index % (2 * size)
        return np.where(index < size, index, 2 * size - 1 - index)
    return index % size
