"""Picture files: PNG through Pillow, EXR through Mitsuba's Bitmap. Both carry facts as text."""

import re

import numpy as np

from ..errors import OutputError
from ..solution.replacing import replacing


def write_png(pixels: np.ndarray, path, facts: dict[str, str]) -> None:
    """Write (height, width, 3) uint8 with text entries.

    Raises:
        OutputError: the file cannot be written.
    """
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    text = PngInfo()
    for key, value in {"software": "radiosity", **facts}.items():
        text.add_itxt(key, value)
    with replacing(path) as temporary:
        Image.fromarray(np.ascontiguousarray(pixels)).save(temporary, format="PNG", pnginfo=text)


def write_exr(values: np.ndarray, path, facts: dict[str, str], bands: tuple[str, ...]) -> None:
    """Write (height, width, n_bands) float32: R, G, B for three bands, Y for one, else a channel named after each band.

    Raises:
        OutputError: the file cannot be written.
    """
    import mitsuba as mi  # its Bitmap needs no variant, and none is set here

    from ..device.backend import bitmaps

    names = [f"band.{re.sub(r'[^A-Za-z0-9]+', '_', band)}" for band in bands] if values.shape[2] not in (1, 3) else []
    image = mi.Bitmap(np.ascontiguousarray(values, np.float32), **({"channel_names": names} if names else {}))
    metadata = image.metadata()
    for key, value in {"software": "radiosity", **facts}.items():
        metadata[key] = value
    with replacing(path) as temporary:
        try:
            with bitmaps():
                image.write(str(temporary))
        except RuntimeError as error:
            raise OutputError(f"{path}: cannot be written ({error})") from error
