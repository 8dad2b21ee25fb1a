"""Coloured meshes: display meshes with values and colours on their vertices, which GLB and PLY files hold."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..scene.up import up_axis
from . import density_mesh, display_mesh, tone
from .look import Look
from .polynomial_light import own_values, vertex_values
from .quantity import choose

FAR = 16  # times its extent: a surface whose coordinates are larger would lose 1e-6 of its size in single precision


@dataclass(frozen=True, eq=False)
class SurfacePart:
    """A surface of a coloured mesh, with vertex numbers of its own; arrays as in `ColouredMesh`, transmittance of its own."""

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    values: np.ndarray
    linear: np.ndarray
    transmittance: float = 0.0

    @property
    def origin(self) -> np.ndarray:
        """Origin of the surface's coordinates, (3,) float64, metres.

        It is a point near the surface, in round numbers, where single precision about the scene's origin would lose 1e-6 of the
        surface's size; elsewhere zeros.
        """
        return origin_of(self.vertices)


def origin_of(vertices: np.ndarray) -> np.ndarray:
    """Return the origin of coordinates, (3,) metres, about which single precision keeps vertices, (n, 3)."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    extent = float((high - low).max())
    if extent == 0 or np.abs([low, high]).max() <= FAR * extent:
        return np.zeros(3)
    step = 2.0 ** np.ceil(np.log2(extent))
    return np.round((low + high) / 2 / step) * step


@dataclass(frozen=True, eq=False)
class ColouredMesh:
    """Triangles with values and colours on their vertices.

    Attributes:
        vertices: (n, 3) float64, metres.
        triangles: (m, 3) int32.
        surface: (m,) int32, surface of each triangle.
        names: of the surfaces.
        values: (n, n_bands) float64, the quantity, in ``unit``; NaN where unknown.
        linear: (n, 3) float64, linear colours: values x ``scale``, not clipped.
        key, unit, bands: which quantity, its unit, and the names of its bands.
        scale: colour for one unit.
        up: ``y`` or ``z``.
        smooth: values are smoothed to shared vertices; otherwise each patch has vertices of its own.
        transmittance: (n_surfaces,) area means; 0 for surfaces that are no panes.
    """

    vertices: np.ndarray
    triangles: np.ndarray
    surface: np.ndarray
    names: tuple[str, ...]
    values: np.ndarray
    linear: np.ndarray
    key: str
    unit: str
    bands: tuple[str, ...]
    scale: float
    up: str
    smooth: bool
    transmittance: np.ndarray

    def facts(self) -> dict:
        """Return what a reader needs to turn colours back into physical values."""
        return {
            "quantity": self.key,
            "unit": self.unit,
            "bands": list(self.bands),
            "scale": self.scale,
            "colour": "linear colour = value x scale, clipped to 1",
            "up": self.up,
            "smoothed": self.smooth,
        }

    def by_surface(self) -> Iterator[SurfacePart]:
        """Yield its surfaces one by one; those without a radiating patch are left out."""
        order = np.argsort(self.surface, kind="stable")
        ends = np.cumsum(np.bincount(self.surface, minlength=len(self.names)))
        local = np.empty(len(self.vertices), np.int32)
        for index, (begin, end) in enumerate(zip(np.concatenate([[0], ends]), ends, strict=False)):
            if begin == end:
                continue
            corners = self.triangles[order[begin:end]]
            used = np.unique(corners)
            local[used] = np.arange(len(used))
            values = self.vertices[used], local[corners], self.values[used], self.linear[used]
            yield SurfacePart(self.names[index], *values, float(self.transmittance[index]))


def coloured(solution, look: Look) -> ColouredMesh:
    """Return the mesh of a solution. The automatic scale is an area-weighted percentile of the patches that do not emit."""
    patches = solution.patches
    shown = choose(solution, look.quantity, look.band)
    dark = ~shown.own_light if not shown.own_light.all() else np.ones(len(patches), bool)
    scale = tone.chosen_scale(look, lambda: tone.automatic_scale(shown.values[dark], patches.area[dark]))
    fitted = look.smooth and look.band is None and look.quantity in ("radiosity", "irradiance")
    if fitted and density_mesh.estimated(solution):
        mesh, values, _ = density_mesh.display(solution, look.quantity)
    elif look.smooth:
        mesh = display_mesh.build(patches)
        values = vertex_values(patches, mesh, shown)
    else:
        whole = display_mesh.build(patches)
        mesh, owner = whole.flat()
        values = own_values(whole, owner, shown)
    triangles, patch = mesh.triangles()
    return ColouredMesh(
        mesh.vertices,
        triangles,
        mesh.surface[patch],
        patches.scene.names,
        values,
        tone.colours(values) * scale,
        look.quantity,
        shown.unit,
        shown.bands,
        scale,
        up_axis(patches.scene),
        look.smooth,
        transmittances(patches.scene),
    )


def transmittances(scene) -> np.ndarray:
    """Return the area mean of each surface, (n_surfaces,)."""
    n = len(scene.names)
    if scene.transmittance is None:
        return np.zeros(n)
    area = np.bincount(scene.surface, scene.area, n)
    return np.bincount(scene.surface, scene.area * scene.transmittance, n) / np.maximum(area, np.finfo(float).tiny)
