"""Patches and their scene in files: arrays by key, and facts for the text of a file. Solutions and line sets share them."""

from dataclasses import asdict
from typing import Any

import numpy as np

from ..patches.model import Patches
from ..scene.camera import Camera
from ..scene.cut import Cut
from ..scene.heat import Heat
from ..scene.lights.model import Lights
from ..scene.model import Scene
from ..scene.paint import Paint
from ..scene.sampler import Sampler
from ..scene.sensor_request import SensorRequest
from . import stored_lights
from .npz import (
    CUT_ARRAYS,
    DIFFUSERS,
    FORMAT_OF_DIFFUSERS,
    FORMAT_OF_GLASS,
    FORMAT_OF_PANES,
    GLASS,
    OWN_ARRAYS,
    PAINT_ARRAYS,
    PANES,
    SCENE_ARRAYS,
)


def stored(patches: Patches) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the arrays of patches and their scene by key, and the facts "scene" and "paints"; with panes "format", too."""
    scene = patches.scene
    arrays = {f"scene_{name}": getattr(scene, name) for name in SCENE_ARRAYS}
    paints = {}
    for which in ("reflectance_paint", "emission_paint"):
        paint = getattr(scene, which)
        if paint is not None:
            arrays |= {f"{which}_{name}": getattr(paint, name) for name in PAINT_ARRAYS}
            arrays |= {f"{which}_picture_{i}": picture for i, picture in enumerate(paint.images)}
            paints[which] = {
                "images": len(paint.images),
                "limit": None if np.isinf(paint.limit) else paint.limit,
                "samplers": [asdict(sampler) for sampler in paint.samplers],
            }
    arrays |= {"patches_columns": patches.columns, "patches_rows": patches.rows}
    arrays |= {f"patches_{name}": getattr(patches, name) for name in OWN_ARRAYS if getattr(patches, name) is not None}
    facts = {
        "names": scene.names,
        "bands": scene.bands,
        "photometric": scene.photometric,
        "scale": scene.scale,
        "source": scene.source,
        "cameras": [asdict(camera) for camera in scene.cameras],
    }
    if scene.heat is not None:
        facts["heat"] = scene.heat.facts()
    if scene.cut is not None:
        arrays |= {f"cut_{name}": getattr(scene.cut, name) for name in CUT_ARRAYS}
        facts["cut"] = scene.cut.whole
    if scene.assumed:
        facts["assumed"] = scene.assumed
    if scene.sensors:
        facts["sensors"] = [request.facts() for request in scene.sensors]
    if scene.lights:
        of_lights, facts["lights"] = stored_lights.stored(scene.lights)
        arrays |= of_lights
    meta: dict[str, Any] = {"paints": paints, "scene": facts}
    for key, value, number in (
        (PANES, scene.transmittance, FORMAT_OF_PANES),
        (DIFFUSERS, scene.diffuse_transmittance, FORMAT_OF_DIFFUSERS),
        (GLASS, scene.refractive_index, FORMAT_OF_GLASS),
    ):
        if value is not None:
            arrays[key], meta["format"] = value, number
    return arrays, meta


def restored(arrays: dict[str, Any], meta: dict[str, Any]) -> Patches:
    """Return the patches that `stored` gave; nothing is checked yet."""
    described = meta["scene"]
    paints = {}
    for which, facts in meta["paints"].items():
        images = tuple(arrays[f"{which}_picture_{i}"] for i in range(facts["images"]))
        limit = np.inf if facts["limit"] is None else facts["limit"]
        samplers = tuple(Sampler(tuple(one["wrap"]), one["filter"]) for one in facts.get("samplers", ()))  # older files: none
        held = {name: arrays[f"{which}_{name}"] for name in PAINT_ARRAYS}
        paints[which] = Paint(images, **held, limit=limit, samplers=samplers)
    scene = Scene(
        **{name: arrays[f"scene_{name}"] for name in SCENE_ARRAYS},
        **paints,
        cameras=tuple(_camera(**fields) for fields in described["cameras"]),
        names=tuple(described["names"]),
        bands=tuple(described["bands"]),
        photometric=described["photometric"],
        scale=described["scale"],
        source=described["source"],
        heat=Heat.of(described["heat"]) if "heat" in described else None,
        assumed=tuple(described.get("assumed", ())),
        lights=stored_lights.restored(arrays, described["lights"]) if "lights" in described else Lights(),
        transmittance=arrays.get(PANES),
        diffuse_transmittance=arrays.get(DIFFUSERS),
        refractive_index=arrays.get(GLASS),
        cut=Cut(described["cut"], *(arrays[f"cut_{name}"] for name in CUT_ARRAYS)) if "cut" in described else None,
        sensors=tuple(SensorRequest.of(facts) for facts in described.get("sensors", ())),
    )
    own = {name: arrays.get(f"patches_{name}") for name in OWN_ARRAYS}
    return Patches(scene, arrays["patches_columns"], arrays["patches_rows"], **own)


def _camera(origin, target, up, **rest) -> Camera:
    return Camera(tuple(origin), tuple(target), tuple(up), **rest)
