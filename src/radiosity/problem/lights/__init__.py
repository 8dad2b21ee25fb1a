"""Lights without area on a device: they fire lines and receive none."""

from .base import AbstractLights, AbstractPointLights

__all__ = ["AbstractLights", "AbstractPointLights"]
