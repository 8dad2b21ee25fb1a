"""Image files as linear images for paints."""

import io
from dataclasses import replace

import numpy as np

from ...errors import SceneError, shown
from ..assemble import Part, ReadOptions, warn


def linear_image(data: bytes, what: str, options: ReadOptions, *, raw: bool = False) -> np.ndarray:
    """Decode a PNG, JPEG, WebP, TGA, ... whose values are sRGB encoded; alpha is left out.

    Args:
        data: the file's bytes.
        what: names the image in errors.
        options: counts its texels.
        raw: its values are linear.

    Returns:
        (height, width, 1 or 3) float32, linear, row 0 at the top.

    Raises:
        SceneError: the bytes are no image that Pillow reads.
    """
    import warnings

    from PIL import Image

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            image = Image.open(io.BytesIO(data))
            wide = image.mode.startswith("I")  # 16 bits a pixel
            grey = image.mode in ("1", "L", "LA")
            floating = image.mode == "F"
            pixels: np.ndarray = np.asarray(image if wide else image.convert("L" if grey else "RGB"))
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
        raise SceneError(f"{what}: the image is too large ({error}); scale it down") from None
    except Exception as error:  # Pillow's decoders raise whatever they like on damaged files
        raise SceneError(f"{what}: the image cannot be decoded ({error}); save it as PNG or JPEG") from None
    if floating:
        raise SceneError(f"{what}: images of floating point numbers are not read in this format; save it as PNG or JPEG")
    most = 65535 if wide else 255
    codes = np.arange(most + 1) / most
    table = np.asarray(codes if raw else decode_srgb(codes), np.float32)
    pixels = np.clip(pixels, 0, most) if wide else pixels
    return reduced(pixels.reshape(*pixels.shape[:2], -1), table.take, what, options)


def decode_srgb(value: np.ndarray) -> np.ndarray:
    """Linear values from sRGB values in [0, 1] (IEC 61966-2-1)."""
    value = np.asarray(value, np.float64)
    return np.where(value <= 0.04045, value / 12.92, ((np.maximum(value, 0) + 0.055) / 1.055) ** 2.4)


def reduced(pixels: np.ndarray, decode, what: str, options: ReadOptions) -> np.ndarray:
    """Decoded rows, float32; averaged in blocks where the image is too large (see `texture_memory`)."""
    edge = options.textures.edge(pixels.shape, what)
    height, width = (min(length, edge) for length in pixels.shape[:2])
    if (height, width) == pixels.shape[:2]:
        return np.ascontiguousarray(decode(pixels), np.float32)
    top = np.linspace(0, pixels.shape[0], height + 1).astype(int)
    left = np.linspace(0, pixels.shape[1], width + 1).astype(int)
    result = np.empty((height, width, pixels.shape[2]), np.float32)
    for row in range(height):
        mean = decode(pixels[top[row] : top[row + 1]]).mean(axis=0)
        result[row] = np.add.reduceat(mean, left[:-1], axis=0) / np.diff(left)[:, None]
    return result


def with_means(part: Part, base: bool, emissive: bool) -> Part:
    """A part whose base or emission texture cannot be placed (no texture coordinates) takes the texture's mean."""
    if base and part.texture is not None:
        mean = part.texture.mean(axis=(0, 1), dtype=np.float64)
        color = np.ones((len(part.vertices), 1)) if part.color is None else part.color
        part = replace(part, texture=None, color=color * mean)
    if emissive and part.emission_texture is not None:
        mean = part.emission_texture.mean(axis=(0, 1), dtype=np.float64)
        glow = tuple(float(v) for v in np.asarray(part.material.emission) * mean)
        part = replace(part, emission_texture=None, material=replace(part.material, emission=glow))
    return part


def warn_of_black(source, without_effect: dict[str, str]) -> None:
    """Tell once of images and strengths that a colour of zero makes black: the colour's name in the file by material."""
    if without_effect:
        names = [f"{name} ({key})" for name, key in without_effect.items()]
        text = "a colour of zero makes black what it multiplies (an image, a strength), as the format says; set it to 1"
        warn(f"{source}: {text}: {shown(names)}")


def warn_of_means(before: list[Part], after: list[Part], source: str) -> None:
    """Tell once which surfaces `with_means` has changed."""
    names = [one.name for one, two in zip(before, after, strict=True) if one is not two]
    if names:
        warn(f"{source}: no texture coordinates, the texture's mean is taken: {shown(dict.fromkeys(names))}")
