"""What is left out or taken in another way: one warning a kind, with the names."""

from ....errors import SceneError, shown
from ...assemble import warn

PATTERNS = "patterns and textures are left out, and materials keep their own colour"
DARK = (
    "lights whose distribution a pattern gives (such as those of ies2rad) are left out, since their power is not known without "
    "it; load the luminaire's file as [[luminaire]] of a .toml"
)
VOID = "surfaces without a material are invisible to Radiance, and left out"
UNDEFINED = (
    "modifiers that the file does not define; where another file does, join them (cat materials.rad room.rad > all.rad), or give "
    "reflectances in a .toml"
)
CONFLICT = "materials that modify another material, which Radiance does not take; the one nearer to the surface holds"
UNKNOWN = "materials that are not read, taken as if there were none"
BLACK = "materials that bend light are taken as black and opaque; make a window of 'glass', or give it a transmittance in a .toml"
COLOURED = "coloured panes let all colours through alike, by their luminance"
ROUGH = "rough materials (trans) let the share that they transmit specularly straight on here, and do not spread it"
NEVER = "glows of negative radius light nothing in Radiance, and are black here"
SPOT = "spotlights send the power of their cone evenly to all sides, not in a cone; a spot of [[luminaire]] in a .toml has a cone"
WINDOWS = "illums are taken by their alternate material, since the file has a sky that shines through them"
ILLUMS = "illums shine as lights, from their front; leave them out where [sky] of a .toml gives their light"
MIST = "volumes of mist are left out"
SKIES = (
    "skies of other patterns than those of gensky and gendaylit are left out; write [sky] in a .toml whose geometry is this file"
)
ANGLES = "sources that are neither a disc below 90 degrees, a half, nor all of the sphere are left out"
TWO_SKIES = "skies that overlap one that comes before are left out"
UNLIT = "sources that do not shine are left out"


LEFT_OUT = (PATTERNS, DARK, UNDEFINED, UNKNOWN, SKIES, ANGLES, TWO_SKIES, UNLIT)  # errors where faults are errors


class Told:
    """What is to be told, by kind."""

    def __init__(self):
        self._found: dict[str, dict[str, None]] = {}

    def add(self, kind: str, name: str) -> None:
        """Remember one that is told of under a kind, a sentence."""
        self._found.setdefault(kind, {})[name] = None

    def warn(self, source: str, strict: bool) -> None:
        """Give one warning a kind.

        Raises:
            SceneError: something is left out, and ``strict``.
        """
        for kind in LEFT_OUT:
            if strict and kind in self._found:
                text = f"{source}: {kind}: {shown(self._found[kind])}"
                raise SceneError(f"{text}; remove that, or read the file without strict")
        for kind, names in self._found.items():
            warn(f"{source}: {kind}: {shown(names)}")
