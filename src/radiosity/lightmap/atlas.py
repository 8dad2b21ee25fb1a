"""Atlases: places on one page for all triangles of a scene, without overlaps, found by xatlas.

Each surface and side has charts of its own, so that the colours of two surfaces never blend, and both sides of a face have
places. Charts may be mirrored. A face too small for xatlas has one texel, and all dark sides share one.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..errors import OutputError
from ..image.output import require
from .triangles import Triangles

LARGEST = 8192  # texels along a page: more is more than most graphics cards take
DEFAULT, WIDEST = 1024, 64  # texels along the page, and of padding at most
EXTENT = (
    100.0  # of the scene in xatlas's units: it drops faces below 1.2e-7 square units, and joins points nearer than 1e-4 or so
)
FILLED = 0.6  # of the page, to begin with
TRIES = 12
FIT = 0.9  # a page that is filled to this share of its side is good


@dataclass(frozen=True, eq=False)
class Atlas:
    """Places of triangles on a page.

    Attributes:
        triangles: of the scene.
        width, height: texels.
        density: texels per metre.
        vertices: (n, 3) float64, metres.
        uv: (n, 2) float64, places of vertices, texels from the first texel's corner.
        corners: (m, 3) int64, vertices of the triangles.
        chart: (m,) int64, number of each triangle's chart; those too small for a chart have one of their own, the dark one.
    """

    triangles: Triangles
    width: int
    height: int
    density: float
    vertices: np.ndarray
    uv: np.ndarray
    corners: np.ndarray
    chart: np.ndarray

    @cached_property
    def places(self) -> np.ndarray:
        """The corners of triangles on the page, (m, 3, 2) float64, texels."""
        return self.uv[self.corners]


def make(triangles: Triangles, *, density: float | None = None, size: int | None = None, padding: int = 4) -> Atlas:
    """Return an atlas.

    Args:
        density: texels per metre.
        size: texels along the page, at most; the density is then the largest that fits.
        padding: texels between charts, 2 or more.

    Raises:
        OutputError: an option makes no sense, the page would be larger than `LARGEST`, or xatlas is not installed.
    """
    check(density, size, padding)
    area = float(_areas(triangles)[~triangles.dark].sum())
    if density is not None:
        if area * density**2 <= LARGEST**2:  # xatlas ends the process where pages are very large
            found = _packed(triangles, density, padding)
            if max(found.width, found.height) <= LARGEST:
                return found
        raise OutputError(
            f"{triangles.scene.source}: {density:g} texels per metre on {area:.4g} m² do not fit on a page of {LARGEST} x "
            f"{LARGEST} texels, which is the most: take fewer per metre, or a size"
        )
    size, best = DEFAULT if size is None else size, None
    low, high, trial = 0.0, np.inf, size * np.sqrt(FILLED / area)
    for _ in range(TRIES):
        found = _packed(triangles, trial, padding)
        side = max(found.width, found.height)
        if side <= size:
            best, low = found, trial
            if side >= FIT * size:
                break
        else:
            high = trial
        ratio = size / side * (0.99 if side > size else 1.0)
        trial = trial * ratio
        if not low < trial < high:
            trial = (low + high) / 2 if np.isfinite(high) else 2 * low
    if best is None:
        raise OutputError(
            f"{triangles.scene.source}: a lightmap of {size} x {size} texels does not hold a place for each of its "
            f"{(~triangles.dark).sum()} triangles with {padding} texels between them: take a larger size, or less padding"
        )
    return best


def check(density, size, padding) -> None:
    """Refuse options that make no sense, and find out whether xatlas is there; see `make`."""
    require("xatlas", "a lightmap", extra="lightmap")
    if density is not None and size is not None:
        raise OutputError("give texels per metre or a size, not both")
    if density is not None and not (np.isfinite(density) and density > 0):
        raise OutputError(f"texels_per_metre is {density}; it must be a positive number")
    for name, value, least, most in (("size", size, 16, LARGEST), ("padding", padding, 2, WIDEST)):
        if value is not None and not (int(value) == value and least <= value <= most):
            raise OutputError(f"{name} is {value}; it must be a whole number of texels from {least} to {most}")


def _areas(triangles: Triangles) -> np.ndarray:
    scene = triangles.scene
    return scene.area[triangles.face] / np.where(scene.is_quad[triangles.face], 2, 1)


def _packed(triangles: Triangles, density: float, padding: int) -> Atlas:
    """Return the atlas that xatlas makes."""
    import xatlas

    scene = triangles.scene
    low = scene.bounds[0]
    unit = EXTENT / float((scene.bounds[1] - low).max())
    points = (scene.vertices - low) * unit
    lit = np.flatnonzero(~triangles.dark)
    corners, ends = triangles.corners()[lit], np.flatnonzero(np.diff(triangles.sheet[lit], append=-1)) + 1
    work, begin, used = xatlas.Atlas(), 0, []
    for end in ends:
        own, local = np.unique(corners[begin:end], return_inverse=True)
        work.add_mesh(points[own].astype(np.float32), local.reshape(-1, 3).astype(np.uint32))
        used.append(own)
        begin = end
    options = xatlas.PackOptions()
    options.padding, options.texels_per_unit, options.bilinear = padding, density / unit, True
    work.generate(xatlas.ChartOptions(), options)
    count = work.atlas_count
    if count > 1:
        raise OutputError(f"{scene.source}: xatlas made {count} pages of a lightmap; take fewer texels per metre")
    vertices, uv, found, chart, shift = [], [], [], [], 0
    for number, own in enumerate(used):
        mapping, indices, coordinates = work.get_mesh(number)
        vertices.append(scene.vertices[own[mapping]])
        uv.append(coordinates.astype(np.float64) * [work.width, work.height])
        found.append(indices.astype(np.int64).reshape(-1, 3) + shift)
        of_vertex = work.get_mesh_vertex_assignment(number)[1].astype(np.int64)  # of all meshes
        chart.append(of_vertex[indices.reshape(-1, 3)[:, 0]])
        shift += len(mapping)
    places, numbers = np.zeros((len(triangles), 3), np.int64), np.zeros(len(triangles), np.int64)
    places[lit], numbers[lit] = np.concatenate(found), np.concatenate(chart)
    joined = np.concatenate(vertices), np.concatenate(uv), places, numbers
    return _with_tiny(Atlas(triangles, int(work.width), int(work.height), density, *joined), padding)


def _with_tiny(atlas: Atlas, padding: int) -> Atlas:
    """Return the atlas with one texel for each triangle that has no place, in rows below the others, and one for the dark."""
    first, second = (atlas.places[:, i] - atlas.places[:, 0] for i in (1, 2))
    tiny = np.flatnonzero(first[:, 0] * second[:, 1] == first[:, 1] * second[:, 0])
    if not len(tiny):
        return atlas
    step = padding + 1
    width = max(atlas.width, step)
    in_row = width // step
    dark = atlas.triangles.dark[tiny]
    k = np.where(dark, (~dark).sum(), np.cumsum(~dark) - 1)
    spots = np.stack([k % in_row, k // in_row], axis=1) * step + 0.5 + [0, atlas.height + padding]
    corners = atlas.corners.copy()
    corners[tiny] = len(atlas.vertices) + np.arange(3 * len(tiny)).reshape(-1, 3)
    chart = atlas.chart.copy()
    chart[tiny] = atlas.chart.max(initial=0) + 1 + k
    vertices = atlas.triangles.scene.vertices[atlas.triangles.corners()[tiny]].reshape(-1, 3)
    return Atlas(
        atlas.triangles,
        width,
        atlas.height + padding + int(k.max() // in_row) * step + 1,
        atlas.density,
        np.concatenate([atlas.vertices, vertices]),
        np.concatenate([atlas.uv, np.repeat(spots, 3, axis=0)]),
        corners,
        chart,
    )
