"""Lights without area in files: arrays by key, and facts for the text of a file."""

from typing import Any

import numpy as np

from ..scene.lights.luminaire import Luminaire
from ..scene.lights.model import Lights
from ..scene.lights.sky import Sky
from ..scene.lights.sun import Sun
from ..scene.lights.web import Web

NAMED = ("name", "group", "source", "soft", "disc", "photometric")
PLACED = ("position", "axes", "power", "size")  # arrays of a luminaire
WEB = ("planes", "gamma", "intensity")


def stored(lights: Lights) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the arrays of lights by key, and facts. Webs that luminaires share are kept once."""
    webs = list(dict.fromkeys(luminaire.web for luminaire in lights.luminaires))  # by identity
    arrays = {f"lights_web_{i}_{name}": getattr(web, name) for i, web in enumerate(webs) for name in WEB}
    facts: dict[str, Any] = {
        "webs": len(webs),
        "luminaires": [_facts(one, NAMED, PLACED) | {"web": webs.index(one.web)} for one in lights.luminaires],
        "suns": [_facts(one, ("name", "diameter", "photometric"), ("direction", "irradiance")) for one in lights.suns],
    }
    if lights.sky is not None:
        arrays["lights_sky_radiance"] = lights.sky.radiance
        facts["sky"] = _facts(lights.sky, ("name", "kind", "photometric"), ("axes",))
    if lights.openings is not None:
        arrays["lights_openings"], facts["openings"] = lights.openings, True
    return arrays, facts


def restored(arrays: dict[str, Any], facts: dict[str, Any]) -> Lights:
    """Return the lights that `stored` gave; nothing is checked yet."""
    webs = [Web(**{name: arrays[f"lights_web_{i}_{name}"] for name in WEB}) for i in range(facts["webs"])]
    luminaires = tuple(Luminaire(**(_made(one, PLACED) | {"web": webs[one["web"]]})) for one in facts["luminaires"])
    suns = tuple(Sun(**_made(one, ("direction", "irradiance"))) for one in facts["suns"])
    sky = Sky(radiance=arrays["lights_sky_radiance"], **_made(facts["sky"], ("axes",))) if "sky" in facts else None
    return Lights(luminaires, suns, sky, arrays["lights_openings"] if facts.get("openings") else arrays.get("lights_openings"))


def _facts(light: Any, plain: tuple[str, ...], as_lists: tuple[str, ...]) -> dict[str, Any]:
    return {name: getattr(light, name) for name in plain} | {name: getattr(light, name).tolist() for name in as_lists}


def _made(facts: dict[str, Any], arrays: tuple[str, ...]) -> dict[str, Any]:
    return facts | {name: np.array(facts[name], np.float64) for name in arrays}
