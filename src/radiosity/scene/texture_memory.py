"""The limit of the texels that images of a scene may have, and the images that were averaged to stay below it."""

from dataclasses import dataclass, field

MOST_TEXELS = 1 << 26  # most texels of all images of a scene together: 0.8 GB of three bands
LARGEST = 4096  # most texels along an edge of an image that is kept whole
SMALL = 1024  # larger images are averaged to this many texels along an edge


@dataclass(eq=False)
class TextureMemory:
    """A count of the texels of the images that a file brings along.

    Attributes:
        left: texels that may still be kept.
        averaged: names of images that were averaged.
    """

    left: int = field(default_factory=lambda: MOST_TEXELS)
    averaged: dict[str, None] = field(default_factory=dict)

    def edge(self, shape: tuple[int, ...], what: str) -> int:
        """The most texels along an edge that an image may keep."""
        height, width = shape[:2]
        texels = height * width
        if max(height, width) <= SMALL or (max(height, width) <= LARGEST and texels <= self.left):
            self.left -= texels
            return LARGEST
        self.averaged[what] = None
        self.left -= min(texels, SMALL**2)
        return SMALL
