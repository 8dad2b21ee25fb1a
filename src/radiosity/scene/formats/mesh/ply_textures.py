"""The textures of a PLY file: which of them each face has, and where its corners lie in it."""

from pathlib import Path

import numpy as np

from ....errors import SceneError
from ...assemble import ReadOptions, warn
from ..beside import in_any_case, warn_of_case
from ..textures import linear_image
from .ply import Ply
from .ply_rows import Columns, Lists

COORDINATES = (("s", "t"), ("u", "v"), ("texture_u", "texture_v"))
NONE = -1


def textures(path: Path, ply: Ply, options: ReadOptions) -> list[np.ndarray | None]:
    """The images that comments name, in their order; None for those that cannot be read (an error where strict)."""
    names = [comment.split(None, 1)[1].strip() for comment in ply.comments if comment.lower().startswith("texturefile ")]
    result: list[np.ndarray | None] = []
    renamed: list[tuple[str, Path]] = []
    for name in names:
        options.admit(path.parent / name, path)
        try:
            file = path.parent / name
            other = None if file.is_file() else in_any_case(path.parent, name)
            if other:
                file = other
                renamed.append((name, file))
            result.append(linear_image(file.read_bytes(), str(file), options))
        except (SceneError, OSError, ValueError) as error:
            text = f"{path}: the texture '{name}' cannot be read ({error})"
            if options.strict:
                raise SceneError(text) from None
            warn(f"{text}; left out")
            result.append(None)
    warn_of_case(path, renamed)
    return result


def of_faces(path: Path, face: Columns, count: int, n_textures: int) -> np.ndarray:
    """Return the number of each polygon's texture, or `NONE`, (count,) int.

    Raises:
        SceneError: a number of a texture that the file does not name.
    """
    if "texnumber" not in face.numbers:
        if n_textures > 1:
            warn(f"{path}: names {n_textures} textures, and faces have no texnumber; all take the first")
        return np.broadcast_to(0 if n_textures else NONE, count)
    number = face.numbers["texnumber"].astype(np.int64)
    wrong = np.flatnonzero(number >= max(n_textures, 1))
    if len(wrong):
        text = f"{path}: face {wrong[0]} has texnumber {number[wrong[0]]}; the file names {n_textures} textures"
        raise SceneError(f"{text} (from 0): add a 'comment TextureFile' for each")
    return np.where((number < 0) | (n_textures == 0), NONE, number)


def of_corners(path: Path, wedges: Lists | None, sizes: np.ndarray) -> tuple[np.ndarray | None, np.ndarray]:
    """Texture coordinates (n_corners, 2) that faces bring along, and which polygons have some; None where no face has.

    Raises:
        SceneError: other than two numbers a corner, or none at all.
    """
    if wedges is None or not wedges.sizes.any():
        return None, np.zeros(len(sizes), bool)
    placed = wedges.sizes > 0
    wrong = np.flatnonzero(placed & (wedges.sizes != 2 * sizes))
    if len(wrong):
        text = f"{path}: face {wrong[0]} has {wedges.sizes[wrong[0]]} texture coordinates for {sizes[wrong[0]]} corners"
        raise SceneError(f"{text}; expected two for each, or none")
    uv = np.zeros((int(sizes.sum()), 2))
    uv[np.repeat(placed, sizes)] = wedges.values.reshape(-1, 2)
    return uv, placed


def of_vertices(vertex: Columns) -> np.ndarray | None:
    """Return texture coordinates of vertices, (n_vertices, 2), or None."""
    held = vertex.numbers
    return next((np.column_stack([held[u], held[v]]) for u, v in COORDINATES if u in held and v in held), None)
