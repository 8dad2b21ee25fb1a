"""Looks: the options that pictures and coloured meshes share."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Look:
    """The quantity to show, and its brightness.

    Attributes:
        quantity: a key of `radiosity.image.quantity.NAMES`.
        band: one band, by name or number; None: all of them (three are shown as red, green and blue, one is grey, and
            of any other number the mean is shown as grey).
        smooth: values are averaged around vertices within a surface and interpolated; otherwise one value a patch.
        exposure: stops brighter than the scale says (+1: twice), or None.
        scale: linear display value for one unit; None: automatic, from the values that are shown.
    """

    quantity: str = "radiosity"
    band: str | int | None = None
    smooth: bool = True
    exposure: float | None = None
    scale: float | None = None
