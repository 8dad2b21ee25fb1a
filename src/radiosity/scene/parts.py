"""Parts of surfaces with materials, which readers of files make, and the options of reading."""

import os
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import SceneError
from .back import Back
from .sampler import DEFAULT_SAMPLER, Sampler
from .texture_memory import TextureMemory


@dataclass(frozen=True)
class Material:
    """What a face does to light. Bands are 1 (grey) or 3 numbers.

    Attributes:
        reflectance: diffuse reflectance, or None where the file gives no material.
        emission: exitance, W/m² or lm/m² (pi times the radiance of a diffuse emitter).
        back: what the back does.
        back_reflectance, back_emission: values of a radiating back; None: those of the front.
        diffuse: False where the file's material is not diffuse and was taken by its diffuse albedo.
        given: the user's own .toml sets the reflectance, below 1: it is taken as it is.
        origin: the file that sets the reflectance, where it is another one than the scene's.
        transmittance: the share of light that goes straight on through a clear pane, from either side.
        refractive_index: above 1: clear glass, whose transmittance, given as its mean over diffuse light, depends on the angle.
        diffuse_transmittance: the share of light on either side that leaves the other side in all directions; None: nothing does.
    """

    reflectance: tuple[float, ...] | None = None
    emission: tuple[float, ...] = (0.0,)
    back: Back = Back.RADIATES
    back_reflectance: tuple[float, ...] | None = None
    back_emission: tuple[float, ...] | None = None
    diffuse: bool = True
    given: bool = False
    origin: str = ""
    transmittance: float = 0.0
    diffuse_transmittance: tuple[float, ...] | None = None
    refractive_index: float = 0.0


@dataclass(frozen=True, eq=False)
class Part:
    """Faces of one surface (object x material).

    Attributes:
        name: the name of the surface. Parts of equal name become one surface.
        vertices: (n, 3) metres.
        faces: (m, 3) or (m, 4) int, as in `Scene.from_arrays`.
        material: the material of all its faces.
        uv: (n, 2) texture coordinates of the vertices, or None.
        color: (n, n_bands) linear vertex colours that multiply the reflectance, or None.
        emission_color: linear vertex colours that multiply the emission, or None.
        texture, emission_texture: (height, width, 1 or 3) linear images that multiply reflectance, emission; or None.
        sampler, emission_sampler: how these images are continued.
        emission_uv: (n, 2) texture coordinates of the emission's texture; None: ``uv``.
        patch_size: metres, or NaN.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    material: Material = field(default_factory=Material)
    uv: np.ndarray | None = None
    color: np.ndarray | None = None
    texture: np.ndarray | None = None
    emission_texture: np.ndarray | None = None
    emission_uv: np.ndarray | None = None
    patch_size: float = np.nan
    sampler: Sampler = DEFAULT_SAMPLER
    emission_sampler: Sampler = DEFAULT_SAMPLER
    emission_color: np.ndarray | None = None

    @property
    def n_bands(self) -> int:
        """Number of bands, 1 or 3."""
        m = self.material
        values = [m.reflectance, m.emission, m.back_reflectance, m.back_emission, m.diffuse_transmittance]
        arrays = [self.color, self.emission_color, self.texture, self.emission_texture]
        return max([1] + [len(v) for v in values if v is not None] + [a.shape[-1] for a in arrays if a is not None])


@dataclass(frozen=True)
class ReadOptions:
    """The options of reading a file.

    Attributes:
        max_reflectance: larger reflectances are brought down to this, with a warning; but not those of the user's own .toml.
        strict: faults that can be skipped are errors.
        edit: changes the parts that were read before they become a scene (the .toml reader's hook).
        root: the folder outside which no file is read, resolved; None: any file may be.
        unit: metres, what the user's own .toml takes a length of 1 for.
        textures: how large images may be; it is used up while files are read.
        read: reads another scene file by its suffix, for a file that names some; `scene.formats.read` hands itself over here.
        files: what has been read, or was to be: the scene file, and all files that it names. Readers add to it.
    """

    max_reflectance: float = 0.95
    strict: bool = False
    edit: Callable[[list[Part]], list[Part]] | None = None
    root: Path | None = None
    unit: float = 1.0
    textures: TextureMemory = field(default_factory=TextureMemory)
    read: Callable[[Path, "ReadOptions"], Any] | None = None
    files: list[Path] = field(default_factory=list)

    def __post_init__(self):
        if not 0 < self.max_reflectance < 1:
            raise SceneError(f"max_reflectance is {self.max_reflectance}; it must be above 0 and strictly below 1, such as 0.95")

    def admit(self, file: Path, source) -> Path:
        """Return a file that the scene file ``source`` asks for, if it lies in the scene's folder. Links are followed first.

        A scene from an unknown source must not read other files of the machine.

        Raises:
            SceneError: the file lies outside.
        """
        try:
            place = Path(os.path.realpath(file))
        except (OSError, ValueError) as error:
            raise SceneError(f"{source}: '{file}' is no path ({error})") from None
        if self.root is not None and not place.is_relative_to(self.root):
            raise SceneError(
                f"{source}: asks for '{file}', which lies outside the scene's folder {self.root}; copy it there, or allow it "
                "with --allow-outside (allow_outside=True)"
            )
        self.files.append(place)
        return file
