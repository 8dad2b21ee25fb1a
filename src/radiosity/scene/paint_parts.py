"""Textures and colours of the parts become one `Paint` of all faces."""

import numpy as np

from .paint import Paint
from .parts import Part


def reflectance_paint(parts: list[Part], n_bands: int, limit: float) -> Paint | None:
    """Of textures and vertex colours; None where no part has any."""
    if all(part.texture is None and part.color is None for part in parts):
        return None
    return _paint(parts, [(part.texture, part.uv, part.color) for part in parts], n_bands, limit)


def emission_paint(parts: list[Part], n_bands: int) -> Paint | None:
    """Of emission textures; None where no part has any."""
    if all(part.emission_texture is None for part in parts):
        return None
    rows = [(p.emission_texture, p.uv if p.emission_uv is None else p.emission_uv, None) for p in parts]
    return _paint(parts, rows, n_bands, np.inf)


def _paint(parts: list[Part], rows, n_bands: int, limit: float) -> Paint:
    total = sum(len(part.faces) for part in parts)
    images: list[np.ndarray] = []
    known: dict[int, int] = {}
    image = np.full(total, -1, np.int32)
    uv = np.zeros((total, 4, 2), np.float32)
    color = np.ones((total, 4, n_bands), np.float32)
    at = 0
    for part, (texture, part_uv, part_color) in zip(parts, rows, strict=True):
        here, corners = slice(at, at + len(part.faces)), np.asarray(part.faces)[:, [0, 1, 2, -1]]
        at += len(part.faces)
        if texture is not None and part_uv is not None:
            if id(texture) not in known:
                known[id(texture)] = len(images)
                images.append(np.broadcast_to(texture, (*texture.shape[:2], n_bands)).astype(np.float32))
            image[here] = known[id(texture)]
            uv[here] = np.asarray(part_uv, np.float32)[corners]
        if part_color is not None:
            color[here] = np.asarray(part_color, np.float32)[corners]
    return Paint(tuple(images), image, uv, color, limit)
