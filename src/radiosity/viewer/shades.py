"""Shades: how the viewer turns values into colours."""

from dataclasses import dataclass

import numpy as np

from ..image import tone
from ..image.false_color import Palette, automatic_limits
from ..image.look import Look
from ..image.quantity import Quantity
from ..scene.formats.textures import decode_srgb

LEGEND = 300  # pixels


@dataclass(frozen=True)
class Shades:
    """The colours asked for.

    Attributes:
        false: colours of a map with a legend; otherwise those of the light itself, three bands as red, green and blue.
        log: of the map: a logarithmic scale.
        limits: of the map, in the quantity's unit; None: automatic.
        color_map: one of matplotlib's.
        exposure: of the light's own colours: stops brighter than the automatic scale.
    """

    false: bool = False
    log: bool = False
    limits: tuple[float, float] | None = None
    color_map: str = "viridis"
    exposure: float = 0.0


@dataclass(frozen=True, eq=False)
class Colours:
    """Shades with the numbers that a quantity gives them.

    Attributes:
        quantity: that is shown.
        palette: of false colours, or None.
        scale: of the light's own colours, linear display value for one unit.
    """

    quantity: Quantity
    palette: Palette | None
    scale: float

    @staticmethod
    def of(shades: Shades, quantity: Quantity, area: np.ndarray) -> "Colours":
        """Find the scale of a quantity, whose patches have these areas, (n_patches,) m²; lamps are left out where others are lit.

        Raises:
            OutputError: the limits are no range, the colour map is unknown, or the exposure is no number of stops.
        """
        dark = ~quantity.own_light if not quantity.own_light.all() else np.ones(len(area), bool)
        values, area = quantity.values[dark], area[dark]
        if shades.false:
            low, high = shades.limits or automatic_limits(values[:, 0], shades.log, area)
            return Colours(quantity, Palette(low, high, shades.log, shades.color_map), 1.0)
        share = 1.0 if quantity.unit == "1" else None  # reflectances are shown as they are: 1 is white
        scale = tone.chosen_scale(Look(exposure=shades.exposure, scale=share), lambda: tone.automatic_scale(values, area))
        return Colours(quantity, None, scale)

    def linear(self, values: np.ndarray) -> np.ndarray:
        """Return linear sRGB colours, (n, 3) in [0, 1], of values (n, n_bands), NaN allowed: black, or grey of false colours."""
        if self.palette is not None:
            return decode_srgb(tone.eight_bits(self.palette(values[:, 0])) / 255)
        return np.clip(np.nan_to_num(tone.colours(values) * self.scale), 0.0, 1.0)

    @property
    def label(self) -> str:
        """The quantity in words, with its unit, and how many patches have no value, or 0 since no line met them."""
        unknown = int((~np.isfinite(self.quantity.values)).any(axis=1).sum())
        unit = "" if self.quantity.unit == "1" else f" [{self.quantity.unit}]"
        shade = "grey" if self.palette is not None else "black"
        unmet = 0 if self.quantity.unmet is None else int(self.quantity.unmet.sum())
        told = f" ({shade}: unknown, {unknown} patches)" if unknown else ""
        return f"{self.quantity.title}{unit}{told}" + (f" ({unmet} patches of value 0: no line met them)" if unmet else "")

    def legend(self, height: int = LEGEND) -> np.ndarray | None:
        """Return a picture of the scale, (height, width, 3) uint8; None where colours are the light's own."""
        if self.palette is None:
            return None
        return self.palette.legend(self.label, self.quantity.values[:, 0], height)
