"""Lights without area and what they light, for the tests."""

from dataclasses import replace

import numpy as np

import radiosity as rd
from radiosity.scene.lights.luminaire import Luminaire
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.sky import Sky
from radiosity.scene.lights.web import Web
from radiosity.scene.shapes import join, quad

ALIKE = Web(np.zeros(1), np.array([0.0, 180]), np.ones((1, 2)))
DOWN = np.array([[1.0, 0, 0], [0, -1, 0], [0, 0, -1]])


def bulb(position, power=4 * np.pi, web: Web = ALIKE, name: str = "bulb", **more) -> Luminaire:
    """A lamp that hangs: gamma = 0 is down."""
    return Luminaire(name, np.asarray(position, float), DOWN, web, np.atleast_1d(power), more.pop("size", np.zeros(3)), **more)


def overcast(zenith: float) -> Sky:
    """CIE's overcast sky, zenith (1 + 2 sin e) / 3, and no ground."""
    return Sky("sky", np.array([0, 0, zenith / 3, zenith])[:, None, None], np.eye(3))


def uniform(radiance: float) -> Sky:
    """Equal radiance above the horizon, none below."""
    return Sky("sky", np.array([0, 0, radiance, radiance])[:, None, None], np.eye(3))


def pebble(where=(4, 4, -0.5)) -> tuple:
    """A small black face out of the way: a scene must have one."""
    return "pebble", 0.0, 0.0, [quad(where, (0, 0.5, 0), (0.5, 0, 0))]


def lit(*parts, photometric: bool = True, **lights) -> rd.Scene:
    """A scene of parts, as `join` takes them, with lights."""
    return replace(join([pebble(), *parts], source="lit"), photometric=photometric, lights=Lights(**lights))
