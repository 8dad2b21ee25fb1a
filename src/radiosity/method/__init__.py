"""The four choices, and the named algorithms made of them."""

from .model import AXES, Method
from .presets import PRESETS, Preset, resolve

__all__ = ["AXES", "PRESETS", "Method", "Preset", "resolve"]
