"""The paint of all faces, made from textures and colours of the parts."""

import numpy as np

from .paint import Paint
from .parts import Part
from .sampler import Sampler


def reflectance_paint(parts: list[Part], n_bands: int, limit: float) -> Paint | None:
    """The paint of textures and vertex colours; None where no part has any."""
    if all(part.texture is None and part.color is None for part in parts):
        return None
    return _paint(parts, [(part.texture, part.sampler, part.uv, part.color) for part in parts], n_bands, limit)


def emission_paint(parts: list[Part], n_bands: int) -> Paint | None:
    """The paint of emission textures and colours; None where no part has any."""
    if all(part.emission_texture is None and part.emission_color is None for part in parts):
        return None
    coordinates = [part.uv if part.emission_uv is None else part.emission_uv for part in parts]
    rows = [
        (part.emission_texture, part.emission_sampler, uv, part.emission_color)
        for part, uv in zip(parts, coordinates, strict=True)
    ]
    return _paint(parts, rows, n_bands, np.inf)


def _paint(parts: list[Part], rows, n_bands: int, limit: float) -> Paint:
    total = sum(len(part.faces) for part in parts)
    images: list[np.ndarray] = []
    samplers: list[Sampler] = []
    known: dict[tuple[int, Sampler], int] = {}
    wide: dict[int, np.ndarray] = {}
    image = np.full(total, -1, np.int32)
    uv = np.zeros((total, 4, 2), np.float32)
    color = np.ones((total, 4, n_bands), np.float32)
    at = 0
    for part, (texture, sampler, part_uv, part_color) in zip(parts, rows, strict=True):
        here, corners = slice(at, at + len(part.faces)), np.asarray(part.faces)[:, [0, 1, 2, -1]]
        at += len(part.faces)
        if texture is not None and part_uv is not None:
            key = id(texture), sampler
            if key not in known:
                known[key] = len(images)
                if id(texture) not in wide:
                    wide[id(texture)] = np.broadcast_to(texture, (*texture.shape[:2], n_bands)).astype(np.float32)
                images.append(wide[id(texture)])
                samplers.append(sampler)
            image[here] = known[key]
            uv[here] = _near(np.asarray(part_uv, np.float64), sampler)[corners]
        if part_color is not None:
            color[here] = np.asarray(part_color, np.float32)[corners]
    return Paint(tuple(images), image, uv, color, limit, tuple(samplers))


def _near(uv: np.ndarray, sampler: Sampler) -> np.ndarray:
    """Coordinates moved by whole periods towards zero, where single precision holds more of them."""
    if not len(uv):
        return uv
    lowest = np.nan_to_num(uv.min(axis=0))
    step = np.array([{"repeat": 1.0, "mirror": 2.0, "clamp": np.inf}[wrap] for wrap in sampler.wrap])
    return uv - np.where(np.isfinite(step), np.floor(lowest / step) * np.where(np.isfinite(step), step, 0), 0)
