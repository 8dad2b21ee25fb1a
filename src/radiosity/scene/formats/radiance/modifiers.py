"""Modifiers of Radiance: names stand for what was defined last before them, and each may have a modifier itself."""

from dataclasses import dataclass, replace

from .primitives import Primitive

PATTERNS = (
    *("colorfunc", "brightfunc", "colordata", "brightdata", "colorpict", "colortext", "brighttext", "spectrum", "specfile"),
    *("specfunc", "specdata", "specpict", "texfunc", "texdata"),
)
VOID = "void"  # the name of no modifier


@dataclass(frozen=True, eq=False)
class Defined:
    """A modifier, and the one that modifies it; None: nothing does."""

    primitive: Primitive
    above: "Defined | str | None"
    alternate: "Defined | str | None" = None


@dataclass(frozen=True)
class Chain:
    """What a surface meets from its modifier upwards.

    Attributes:
        material: the first material; None: there is none.
        patterns: patterns and textures on the way.
        undefined: names that nothing defines.
        conflicting: further materials, which Radiance does not take.
        alternate: the chain of the material's alternate, of an illum.
    """

    material: Primitive | None = None
    patterns: tuple[Primitive, ...] = ()
    undefined: tuple[str, ...] = ()
    conflicting: tuple[Primitive, ...] = ()
    alternate: "Chain | None" = None


class Modifiers:
    """All modifiers so far."""

    def __init__(self):
        self._defined: dict[str, Defined] = {}

    def define(self, primitive: Primitive) -> None:
        """Add a pattern, texture, mixture or material."""
        alternate = None
        if primitive.kind in ("illum", "mirror") and primitive.words:
            alternate = self.find(primitive.words[0])
        self._defined[primitive.name] = Defined(primitive, self.find(primitive.modifier), alternate)

    def alias(self, primitive: Primitive) -> bool:
        """Add an alias: a modifier with the type and arguments of another. Return whether that is one."""
        found = self._defined.get(primitive.words[0])
        if found is None:
            return False
        above = found.above if primitive.modifier == "inherit" else self.find(primitive.modifier)
        named = replace(found.primitive, name=primitive.name)
        self._defined[primitive.name] = replace(found, primitive=named, above=above)
        return True

    def find(self, name: str) -> Defined | str | None:
        """What a name stands for now: a modifier, None for "void", or the name itself where nothing defines it."""
        return None if name == VOID else self._defined.get(name, name)


def chain_of(start: Defined | str | None) -> Chain:
    """Return what a surface with this modifier meets."""
    material, alternate, patterns, conflicting, undefined = None, None, [], [], ()
    while start is not None:
        if isinstance(start, str):
            undefined = (start,)
            break
        if start.primitive.kind in PATTERNS:
            patterns.append(start.primitive)
        elif material is None:
            material, alternate = start.primitive, start.alternate
        else:
            conflicting.append(start.primitive)
        start = start.above
    below = None if alternate is None else chain_of(alternate)
    return Chain(material, tuple(patterns), undefined, tuple(conflicting), below)
