"""Files that a Mitsuba scene names, and those that are images."""

from pathlib import Path

import numpy as np

from ....errors import SceneError
from ...parts import ReadOptions
from ..beside import in_any_case, warn_of_case
from ..textures import linear_image, reduced
from .node import Node
from .parse import message

FLOAT_IMAGES = (".exr", ".hdr", ".pfm", ".rgbe")


def find_file(folders: list[Path], name: str, node: Node, options: ReadOptions) -> Path:
    """A file that a plugin names, in one of the folders or beside the XML file that names it.

    Raises:
        SceneError: there is none, or it lies outside the scene's folder.
    """
    source = Path(node.place.rsplit(" (", 1)[0])
    plain = name.replace("\\", "/")
    for folder in (*folders, source.parent):
        for file in (folder / name, folder / plain):
            if file.is_file():
                return options.admit(file, node.place)
    for folder in dict.fromkeys((folders[0], source.parent)):
        if plain and (other := in_any_case(folder, plain)):
            warn_of_case(source, [(plain, other)])
            return options.admit(other, node.place)
    raise SceneError(f"{node.place}: the file '{name}' of this '{node.plugin}' does not exist in {folders[0]}")


def read_image(file: Path, raw: bool, options: ReadOptions) -> np.ndarray:
    """Return an image, (height, width, 1 or 3) float32; linear, or where ``raw`` the values as they are in the file.

    Raises:
        SceneError: the file is no image.
    """
    if file.suffix.lower() in FLOAT_IMAGES:
        return reduced(_float_image(file), lambda block: block, str(file), options)
    return linear_image(file.read_bytes(), str(file), options, raw=raw)


def _float_image(file: Path) -> np.ndarray:
    import mitsuba

    from ....device.backend import bitmaps  # imported here: it takes a while to start

    try:
        with bitmaps():
            bitmap = mitsuba.Bitmap(str(file))
        grey = bitmap.pixel_format() in (mitsuba.Bitmap.PixelFormat.Y, mitsuba.Bitmap.PixelFormat.YA)
        kind = mitsuba.Bitmap.PixelFormat.Y if grey else mitsuba.Bitmap.PixelFormat.RGB
        bitmap = bitmap.convert(kind, mitsuba.Struct.Type.Float32, False)
    except Exception as error:  # of many classes
        raise SceneError(f"{file}: the image cannot be decoded ({message(error, file)})") from None
    return np.atleast_3d(np.array(bitmap))
