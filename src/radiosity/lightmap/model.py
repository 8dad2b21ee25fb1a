"""The model of a lightmap: values of texels, where they lie, and how they are written."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from ..image import bitmap, curves, tone
from ..image.look import Look
from ..image.output import check_writable, require
from .atlas import Atlas
from .texels import Texels

SUFFIXES = (".glb",)


@dataclass(frozen=True, eq=False)
class Lightmap:
    """Light on a texture; `radiosity.bake_lightmap` makes one.

    Attributes:
        values: (height, width, n_bands) float64 in ``unit``. Texels of no surface have the value of the nearest that is of one.
        standard_error: the same shape, of the gather's lines alone; None unless asked for.
        covered: (height, width) bool, texels that stand for a point of a surface.
        own_light: (height, width) bool, texels on lamps.
        quantity, unit, bands: what they hold.
        texels_per_metre: their density.
        atlas, texels: where triangles and texels lie.
        facts: how it was made.

    Example:
        >>> solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=2), rays=20_000)
        >>> lightmap = rd.bake_lightmap(solution, size=64, lines=16)
        >>> lightmap.values.shape[2], lightmap.unit, bool(lightmap.covered.mean() > 0.3)
        (1, 'W/m²', True)
    """

    values: np.ndarray
    standard_error: np.ndarray | None
    covered: np.ndarray
    own_light: np.ndarray
    quantity: str
    unit: str
    bands: tuple[str, ...]
    texels_per_metre: float
    atlas: Atlas
    texels: Texels
    facts: dict[str, str]

    @cached_property
    def scale(self) -> float:
        """The automatic scale: it takes the 97th percentile of the texels to a light tone, lamps apart."""
        on = self.covered & ~self.own_light
        return tone.automatic_scale(self.values[on if on.any() else self.covered])

    def image(self, *, exposure: float | None = None, scale: float | None = None, tone_map: str = "clip") -> np.ndarray:
        """The lightmap as a picture, (height, width, 3) uint8.

        Args:
            exposure, scale: stops brighter than the scale says, and the display value of one unit (default: `scale`).
            tone_map: clip, filmic or agx.
        """
        factor = tone.chosen_scale(Look(exposure=exposure, scale=scale), lambda: self.scale)
        return curves.displayed(self.values, factor, curves.checked(tone_map))

    def save(
        self, path, *, exposure: float | None = None, scale: float | None = None, tone_map: str = "clip"
    ) -> tuple[Path, ...]:
        """Write a GLB file with the lightmap as its texture, and beside it ``NAME.exr`` with the values.

        Where there are errors, ``NAME.error.exr`` has them.

        Args: see `image`.

        Returns:
            The files that were written.

        Raises:
            OutputError: a file cannot be written, or an option makes no sense.
        """
        from . import glb

        files = check(path, errors=self.standard_error is not None)
        factor = tone.chosen_scale(Look(exposure=exposure, scale=scale), lambda: self.scale)
        pixels = self.image(scale=factor, tone_map=tone_map)
        facts = {"quantity": self.quantity, "unit": self.unit, "bands": ", ".join(self.bands), **self.facts}
        shown = facts | {"scale": repr(factor), "colour": curves.WORDS[tone_map]}
        glb.write(self, files[0], pixels, shown)
        for file, values in zip(files[1:], (self.values, self.standard_error), strict=False):
            assert values is not None
            bitmap.write_exr(values.astype(np.float32), file, facts, self.bands)
        return files


def check(path, *, errors: bool = False) -> tuple[Path, ...]:
    """Return the files that a lightmap is written to, and find out beforehand whether they can be.

    Raises:
        OutputError: one cannot be written, or Pillow is not installed.
    """
    path = check_writable(path, SUFFIXES)
    require("PIL", f"{path}: writing PNG")
    beside = [path.with_suffix(".exr"), *([path.with_suffix(".error.exr")] if errors else [])]
    return (path, *(check_writable(file, (".exr",)) for file in beside))
