"""Everything that decides how the page looks, as one value."""

from dataclasses import dataclass, field

from .picking import Cut
from .shades import Shades

FLAT, SMOOTH = "patches", "smooth"


@dataclass(frozen=True)
class Look:
    """What is shown, and how.

    Attributes:
        quantity: a key of `Subject.names`; None: the first.
        band: one band by name; None: all.
        smooth: values are interpolated within surfaces; otherwise each patch has one colour.
        shades: the colours.
        wireframe: the edges of patches are drawn.
        cut: a plane that cuts away what lies beyond it, or None.
        hidden: surfaces that are not shown, by number.
        marks: sensors and luminaires are shown.
    """

    quantity: str | None = None
    band: str | None = None
    smooth: bool = True
    shades: Shades = field(default_factory=Shades)
    wireframe: bool = False
    cut: Cut | None = None
    hidden: frozenset[int] = frozenset()
    marks: bool = True
