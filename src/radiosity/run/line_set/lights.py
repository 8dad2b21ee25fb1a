"""Lights without area, whose lines no line set counts: they are left out of its solutions, and told."""

import warnings
from dataclasses import replace

from ...errors import RadiosityWarning, shown
from ...patches import Patches
from ...scene.lights.model import Lights


def without_lights(patches: Patches) -> Patches:
    """Return the patches of the scene without its luminaires, suns and sky; one warning names them."""
    scene = patches.scene
    if not scene.lights:
        return patches
    names = shown([one.name for one in scene.lights.all])
    warnings.warn(
        f"{scene.source}: lights without area are left out of what line sets are solved for: {names}; for their light take "
        "radiosity.solve with gather or random-walk",
        RadiosityWarning,
        stacklevel=3,
    )
    return replace(patches, scene=replace(scene, lights=Lights()))
