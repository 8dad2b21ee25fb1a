"""The four choices and the named algorithms made of them, and the baselines, which have choices of their own."""

from .auto import Auto
from .baseline import Baseline
from .model import AXES, Method
from .presets import BASELINES, PRESETS, Preset, resolve

__all__ = ["AXES", "BASELINES", "PRESETS", "Auto", "Baseline", "Method", "Preset", "resolve"]
