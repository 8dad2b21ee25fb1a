"""Samplers: how an image is continued outside the unit square, and between the centres of its texels."""

from dataclasses import dataclass

import numpy as np

WRAPS = ("repeat", "mirror", "clamp")
FILTERS = ("linear", "nearest")


@dataclass(frozen=True)
class Sampler:
    """The wraps and the filter of an image.

    Attributes:
        wrap: along u and along v, each one of `WRAPS`.
        filter: one of `FILTERS`: between the centres of four texels, or of the texel that holds the point.
    """

    wrap: tuple[str, str] = ("repeat", "repeat")
    filter: str = "linear"

    def __post_init__(self):
        if len(self.wrap) != 2 or any(wrap not in WRAPS for wrap in self.wrap) or self.filter not in FILTERS:
            raise ValueError(f"wrap {self.wrap!r} and filter {self.filter!r}; known are {WRAPS} and {FILTERS}")


DEFAULT_SAMPLER = Sampler()


def fold(texel: np.ndarray, count: int, wrap: str) -> np.ndarray:
    """Return texels of the image, 0 to count - 1, from texels anywhere on the axis."""
    if wrap == "clamp":
        return np.clip(texel, 0, count - 1)
    if wrap == "repeat":
        return texel % count
    texel = texel % (2 * count)
    return np.minimum(texel, 2 * count - 1 - texel)


def periods(count: int, wrap: str) -> int:
    """The number of texels after which the axis repeats; 0: it does not."""
    return {"repeat": count, "mirror": 2 * count if count > 1 else 1, "clamp": 0}[wrap]
