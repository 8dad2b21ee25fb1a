"""Cutting faces into congruent cells."""

from numbers import Real

import numpy as np

from ..errors import SceneError
from ..hooks import HOOKS
from ..pieces import of_pieces
from ..scene.model import Back, Scene
from . import cells as grid
from .model import Patches

DEFAULT_PATCHES = 20_000
MOST_PATCHES = 2**31 - 2**16
SLACK = 1 + 1e-7  # times the smallest size that is enough: faces of one size are cut alike wherever they lie, rounded or not


def subdivide(
    scene: Scene,
    *,
    size: float | None = None,
    cells: int | None = None,
    about: int = DEFAULT_PATCHES,
    powers_of_two: bool = False,
    contacts: bool = False,
    patches: int | None = None,
) -> Patches:
    """Cut every face into patches.

    Args:
        size: metres. A parallelogram's cell edges are at most this long, a triangle's cell has at most half its
            square as area. Surfaces with a patch size of their own in the scene keep it.
        cells: every face into cells x cells instead (1: a patch for each face and radiating side).
            Neither: a size at which the faces large enough to be cut give about as many patches as ``about`` says; the
            others are one for each side.
        powers_of_two: columns and rows are rounded up to powers of two, so that the patches are the leaves of a `Hierarchy`;
            what is said of size, cells and about still holds.
        contacts: cut faces first along the outlines of what touches them or lies just in front of them, lamps before others, as
            `adapt` does; their parts have the same size. Each part is a face of the scene of the patches.
        patches: so many patches at most, which follow the light instead, see `adapt`.

    Raises:
        SceneError: size and cells are both given, a value makes no sense, or there are more patches than can be counted.

    Example:
        >>> room = rd.load_scene("room")
        >>> len(rd.subdivide(room, cells=1)), len(rd.subdivide(room, size=0.5))
        (18, ...)
    """
    if not isinstance(scene, Scene):
        raise SceneError(f"subdivide takes a Scene, not {type(scene).__name__}; load a file with load_scene")
    if patches is not None:
        if size is not None or cells is not None or powers_of_two or contacts or about != DEFAULT_PATCHES:
            raise SceneError("patches=N cuts where light varies; leave out size, cells, about, powers_of_two and contacts")
        return HOOKS["adapt"](scene, patches)
    if size is not None and cells is not None:
        raise SceneError("give size or cells, not both")
    if cells is not None and contacts:
        raise SceneError("contacts cuts faces into parts of unlike size: give a size, or leave cells out")
    if isinstance(about, bool) or not isinstance(about, int) or about < 1:
        raise SceneError(f"about is {about!r}; it must be a whole number of patches, 1 or more")
    if cells is not None:
        if isinstance(cells, bool) or not isinstance(cells, Real) or not np.isfinite(cells) or int(cells) != cells or cells < 1:
            raise SceneError(f"cells is {cells!r}; it must be a whole number of 1 or more")
        columns = rows = _rounded(np.full(scene.n_faces, min(int(cells), 2**31), np.int64), powers_of_two)
    else:
        if size is not None and not (isinstance(size, Real) and np.isfinite(size) and size > 0):
            raise SceneError(f"patch size is {size!r}; it must be a positive number of metres")
        size = _default_size(scene, powers_of_two, about) if size is None else float(size)
        columns, rows = _by_size(_edges(scene), _own_sizes(scene), size, powers_of_two)
        if contacts:
            scene = HOOKS["cut at contacts"](_checked(scene, columns, rows))
            columns, rows = _by_size(_edges(scene), _own_sizes(scene), size, powers_of_two)
    return _checked(scene, columns, rows)


def _edges(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    _, first, second = scene.frames
    half = np.sqrt(2 * scene.area)
    return tuple(np.where(scene.is_quad, np.linalg.norm(edge, axis=1), half) for edge in (first, second))  # type: ignore[return-value]


def _rounded(counts: np.ndarray, powers_of_two: bool) -> np.ndarray:
    """Return counts of 1 or more, rounded up to the next power of two where that is asked for."""
    if not powers_of_two:
        return counts
    _, exponent = np.frexp(counts.astype(np.float64) - 1)  # the bits of count - 1; exact, since counts are whole
    return (2 ** exponent.astype(np.int64)).astype(counts.dtype)


def _own_sizes(scene: Scene) -> np.ndarray | None:
    """Return the patch size that each face's surface asks for, (n_faces,), NaN for none; None where no surface asks."""
    return scene.patch_size[scene.surface] if np.isfinite(scene.patch_size).any() else None


def _by_size(edges, own: np.ndarray | None, size: float, powers_of_two: bool) -> tuple[np.ndarray, np.ndarray]:
    """Return columns and rows of faces with these edges, (m,) float64 each."""
    wanted = size if own is None else np.where(np.isfinite(own), own, size)
    columns, rows = (np.maximum(np.ceil(edge / wanted * (1 - 1e-9)), 1) for edge in edges)
    return tuple(_rounded(np.minimum(count, 2**31), powers_of_two) for count in (columns, rows))  # type: ignore[return-value]


def _default_size(scene: Scene, powers_of_two: bool, about: int) -> float:
    """Return a size at which the faces that are cut at all give about ``about`` patches.

    So walls are cut however many tiny faces there are beside them.
    """
    sides = np.where(scene.back == Back.RADIATES, 2, 1)
    edges, own = _edges(scene), _own_sizes(scene)

    def patches_cut(size: float) -> float:
        def of(part: slice) -> float:
            columns, rows = _by_size([edge[part] for edge in edges], None if own is None else own[part], size, powers_of_two)
            cells = columns * rows
            return float((cells * sides[part])[cells > 1].sum())

        return sum(of_pieces(of, scene.n_faces))

    high = float(max(edge.max() for edge in edges))
    low = high * 1e-6
    for _ in range(60):
        middle = np.sqrt(low * high)
        low, high = (middle, high) if patches_cut(middle) > about else (low, middle)
    return high * SLACK


def _checked(scene: Scene, columns, rows) -> Patches:
    sides = np.where(scene.back == Back.RADIATES, 2, 1)
    total = float((columns.astype(np.float64) * rows * sides).sum())
    if max(columns.max(), rows.max()) > grid.MOST:
        face = int(np.argmax(np.maximum(columns, rows)))
        raise SceneError(
            f"{scene.source}: face {face} of surface '{scene.names[scene.surface[face]]}' would have "
            f"{int(max(columns[face], rows[face]))} cells along an edge, more than {grid.MOST}; take larger patches"
        )
    if total > MOST_PATCHES:
        raise SceneError(f"{scene.source}: {total:.3g} patches, more than {MOST_PATCHES}; take larger patches")
    return Patches(scene, columns.astype(np.int32), rows.astype(np.int32))
