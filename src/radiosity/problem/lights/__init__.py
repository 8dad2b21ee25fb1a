"""Lights without area on a device: they fire lines and receive none."""

from .base import AbstractLights, AbstractPointLights, AbstractSky

__all__ = ["AbstractLights", "AbstractPointLights", "AbstractSky"]
