"""A scene: flat diffuse faces with reflectance and self-emitted radiosity, in metres and W/m² (or lm/m²)."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from .back import Back
from .camera import Camera
from .cut import Cut
from .geometry import frames_of, plane_reach_of, unit_normals
from .hashes import geometry_hash_of, hash_of
from .heat import Heat
from .lights.luminaire import Luminaire
from .lights.model import Lights
from .lights.sky import Sky
from .lights.sun import Sun
from .measures import Also, Measures, measured, median_centre
from .paint import Paint
from .sensor_request import SensorRequest
from .taking import is_cut_of, taken

__all__ = ["Back", "Scene", "unit_normals"]


@dataclass(frozen=True, eq=False)
class Scene:
    """Faces and what they do to light. Build one with `Scene.from_arrays` or `radiosity.load_scene`.

    Attributes:
        vertices: (n_vertices, 3) float64, metres.
        faces: (n_faces, 4) int64. Corners counterclockwise seen from the front; a triangle has -1 in the last
            column, every other face is a parallelogram.
        reflectance: (n_faces, n_bands) float64 in [0, 1), of the front; 0 where ``back`` is OPEN.
        emission: (n_faces, n_bands) float64, self-emitted radiosity (exitance) of the front, W/m² or lm/m².
        back: (n_faces,) uint8, a `Back`.
        back_reflectance, back_emission: the same of the back; used where ``back`` is RADIATES.
        surface: (n_faces,) int32 index into ``names``.
        names: surface names.
        bands: band names, ("grey",) or ("red", "green", "blue").
        photometric: units are lm/m², not W/m².
        patch_size: (n_surfaces,) float64 metres, NaN where the scene asks for none.
        reflectance_paint, emission_paint: variation within faces, or None.
        cameras: cameras found in the file.
        scale: metres per unit of length of the file (already applied).
        source: where the scene comes from, for messages.
        heat: what the file says about temperatures, or None; light does not depend on it.
        assumed: names of surfaces whose reflectance no file gives; a default was taken.
        lights: luminaires, suns and the sky, which are no surfaces.
        transmittance: (n_faces,) float64 in [0, 1), the share of lines that goes straight on through each face from either side
            (panes), equal in all bands; None where no face is a pane.
        diffuse_transmittance: (n_faces, n_bands) float64 in [0, 1), the share of what falls on either side that leaves the other
            side in all directions (diffusing panes); None where there is none. Both sides of such faces radiate.
        refractive_index: (n_faces,) float64, above 1 of clear glass, whose transmittance depends on the angle (``transmittance``
            is the mean over diffuse light); 0 for other faces, and None where there is no such glass.
        sensors: what the file asks `measure` for; light does not depend on it.
        cut: what the faces are parts of, where a mesh follows the light (`subdivide(scene, patches=...)`); else None.

    Example:
        >>> corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        >>> scene = rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], reflectance=0.5, emission=100, names=["lamp"])
        >>> scene.area.tolist(), scene.normal.tolist(), scene.unit
        ([1.0], [[0.0, 0.0, 1.0]], 'W/m²')
    """

    vertices: np.ndarray
    faces: np.ndarray
    reflectance: np.ndarray
    emission: np.ndarray
    back: np.ndarray
    back_reflectance: np.ndarray
    back_emission: np.ndarray
    surface: np.ndarray
    names: tuple[str, ...]
    bands: tuple[str, ...] = ("grey",)
    photometric: bool = False
    patch_size: np.ndarray = field(default_factory=lambda: np.zeros(0))
    reflectance_paint: Paint | None = None
    emission_paint: Paint | None = None
    cameras: tuple[Camera, ...] = ()
    scale: float = 1.0
    source: str = "arrays"
    heat: Heat | None = None
    assumed: tuple[str, ...] = ()
    lights: Lights = field(default_factory=Lights)
    transmittance: np.ndarray | None = None
    diffuse_transmittance: np.ndarray | None = None
    refractive_index: np.ndarray | None = None
    sensors: tuple[SensorRequest, ...] = ()
    cut: Cut | None = None

    @staticmethod
    def from_arrays(
        vertices,
        faces,
        reflectance,
        emission,
        *,
        surface=None,
        names=None,
        two_sided: ArrayLike = False,
        back=None,
        back_reflectance=None,
        back_emission=None,
        bands=None,
        photometric=False,
        transmittance=None,
        diffuse_transmittance=None,
        refractive_index=None,
        cameras=(),
        source="arrays",
    ) -> "Scene":
        """A scene from arrays; values are checked, never repaired.

        Args:
            vertices: (n_vertices, 3) metres.
            faces: (n_faces, 3) triangles or (n_faces, 4) quadrilaterals (-1 in the last column: a triangle),
                corners counterclockwise seen from the front. A quadrilateral that is no parallelogram becomes two triangles.
            reflectance: a number, (n_faces,), (1, n_bands) or (n_faces, n_bands), in [0, 1).
            emission: likewise, self-emitted radiosity (exitance), W/m², not negative.
            surface: (n_faces,) index of each face's surface; default: one surface.
            names: a name for each surface.
            two_sided: bool or (n_faces,): the back radiates like the front. Otherwise it absorbs.
            back: (n_faces,) of `Back`, instead of ``two_sided``.
            back_reflectance, back_emission: of radiating backs, default as the front.
            bands: band names; default ("grey",), ("red", "green", "blue") or numbers.
            photometric: emission is in lm/m².
            transmittance: a number or (n_faces,) in [0, 1): the share of light that goes straight on through a face (a clear
                pane), from either side. With the reflectance of each side it must stay below 1; the rest is absorbed.
            diffuse_transmittance: like ``reflectance``, the share of light on either side that leaves the other side in all
                directions (a diffusing pane). The faces must be two-sided, and all shares together stay below 1.
            refractive_index: a number or (n_faces,): above 1 for clear glass, which lets less light through at flat angles, by
                Fresnel's formulas; ``transmittance`` is the mean over diffuse light. 0: one transmittance for all angles.
                Glass reflects, emits and diffuses nothing here.

        Raises:
            SceneError: shapes, indices or values out of range; nothing left that has an area.
        """
        from .arrays import checked_fields

        fields, _ = checked_fields(
            vertices,
            faces,
            reflectance,
            emission,
            surface=surface,
            names=names,
            two_sided=two_sided,
            back=back,
            back_reflectance=back_reflectance,
            back_emission=back_emission,
            bands=bands,
            photometric=photometric,
            transmittance=transmittance,
            diffuse_transmittance=diffuse_transmittance,
            refractive_index=refractive_index,
            cameras=cameras,
            source=source,
        )
        return Scene(**fields).without_degenerate_faces()

    @property
    def n_faces(self) -> int:
        """Number of faces."""
        return len(self.faces)

    @property
    def n_bands(self) -> int:
        """Number of bands."""
        return self.reflectance.shape[1]

    @property
    def panes(self) -> np.ndarray:
        """True where a face lets light through from both sides, (n_faces,) bool."""
        return np.zeros(self.n_faces, bool) if self.transmittance is None else self.transmittance > 0

    @property
    def diffusers(self) -> np.ndarray:
        """True where light leaves the other side of a face in all directions, (n_faces,) bool."""
        diffuse = self.diffuse_transmittance
        return np.zeros(self.n_faces, bool) if diffuse is None else (diffuse > 0).max(axis=1)

    @property
    def unit(self) -> str:
        """Unit of radiosity and exitance, W/m² or lm/m²."""
        return "lm/m²" if self.photometric else "W/m²"

    @property
    def irradiance_unit(self) -> str:
        """Unit of irradiance: W/m², or lx where it is illuminance."""
        return "lx" if self.photometric else "W/m²"

    @property
    def radiance_unit(self) -> str:
        """Unit of radiance: W/(m² sr), or cd/m² where it is luminance."""
        return "cd/m²" if self.photometric else "W/(m² sr)"

    @property
    def power_unit(self) -> str:
        """Unit of power, W or lm."""
        return "lm" if self.photometric else "W"

    @cached_property
    def is_quad(self) -> np.ndarray:
        """True where a face is a parallelogram, not a triangle, (n_faces,) bool."""
        return self.faces[:, 3] >= 0

    @cached_property
    def frames(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Origin and two edges of each face, (n_faces, 3) each: a point is origin + u edge_1 + v edge_2."""
        return frames_of(self.vertices, self.faces)

    @cached_property
    def measures(self) -> Measures:
        """The sizes of the faces."""
        return measured(self.vertices, self.faces)

    def measure(self, also: Also) -> None:
        """Find `measures`; each piece of the faces goes to ``also``, too."""
        vars(self)["measures"] = measured(self.vertices, self.faces, also)

    @property
    def area(self) -> np.ndarray:
        """The area of one side of each face, (n_faces,) m²."""
        return self.measures.area

    @cached_property
    def normal(self) -> np.ndarray:
        """The unit normal of each front, (n_faces, 3)."""
        _, first, second = self.frames
        return unit_normals(first, second)

    @property
    def bounds(self) -> np.ndarray:
        """The lowest and highest coordinates, (2, 3) metres."""
        return self.measures.bounds

    @cached_property
    def centre(self) -> np.ndarray:
        """The origin of coordinates in single precision, (3,) float64 metres; see `scene.precision`.

        It is the middle of the box where the scene has no area.
        """
        return median_centre(self.vertices, self.faces, self.measures)

    @cached_property
    def reach(self) -> float:
        """The largest coordinate of a face about the centre, metres."""
        return float(np.abs(self.bounds - self.centre).max())

    @cached_property
    def plane_reach(self) -> np.ndarray:
        """The size of the numbers that place each face's plane, (n_faces,) metres; see `scene.precision.plane_reach`."""
        return plane_reach_of(self.vertices - self.centre, self.faces, self.normal)

    @cached_property
    def hash(self) -> str:
        """SHA-256 of everything that a solution depends on."""
        return hash_of(self)

    @cached_property
    def geometry_hash(self) -> str:
        """SHA-256 of everything that lines depend on: faces, backs, panes and surfaces, and neither emission nor reflectance."""
        return geometry_hash_of(self)

    def is_cut_of(self, scene: "Scene", any_light: bool = False) -> bool:
        """Return whether the faces are parts of the faces of that scene, with the same light and colours.

        Args:
            any_light: they may have got another light, or other colours, since they were cut.
        """
        return is_cut_of(self, scene, any_light)

    def take(self, keep: np.ndarray) -> "Scene":
        """The scene of a choice of faces (indices or mask)."""
        return taken(self, keep)

    def with_lights(
        self, luminaires: Iterable[Luminaire] = (), *, suns: Iterable[Sun] = (), sky: Sky | None = None, openings=None
    ) -> "Scene":
        """The scene with more lights that are no surfaces.

        Args:
            luminaires: from `radiosity.read_luminaire` and `radiosity.point_light`.
            suns, sky: lights from far away.
            openings: of each three or four corners, m, around a convex polygon through which the sky and the suns light most of
                what matters, such as a window.

        Raises:
            SceneError: some light of the scene is in W and other light in lm, there are two skies, or a value makes no sense.

        Example:
            >>> floor = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]]
            >>> scene = rd.Scene.from_arrays(floor, [[0, 1, 2, 3]], reflectance=0.5, emission=0)
            >>> lit = scene.with_lights([rd.point_light(position=(2, 2, 2.5), lumens=800)])
            >>> lit.unit, len(lit.lights.luminaires)
            ('lm/m²', 1)
        """
        from .lights.add import with_lights
        from .lights.given import given

        return with_lights(self, given(luminaires, suns, sky, openings, self.source))

    def without_degenerate_faces(self) -> "Scene":
        """Leave out, with one warning, faces that single precision cannot tell from a line or a point where they lie.

        Raises:
            SceneError: no face is left.
        """
        from .degenerate import leave_out

        return leave_out(self)
