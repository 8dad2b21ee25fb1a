"""Loading of a saved radiative exchange."""

from pathlib import Path
from typing import Any

import numpy as np

from ..solution.npz import EXCHANGE, FORMATS_OF_PANES
from ..solution.reading import read
from ..solution.stored_patches import restored
from ..solution.validate import validate_patches
from .result import RadiativeExchange
from .saving import FORMAT, MATRICES, PATCHES, REST, SCALARS, SURFACES

ERRORS = (
    "net_standard_error",
    "temperature_standard_error",
    "patch_net_standard_error",
    "exchange_standard_error",
    "temperature",
)


def load_exchange(path) -> RadiativeExchange:
    """Read a radiative exchange saved by `RadiativeExchange.save`.

    Raises:
        SceneError: the file is missing, damaged, or something else.

    Example:
        >>> maze = rd.subdivide(rd.load_scene("labyrinth"), cells=1)
        >>> heat = rd.radiative_exchange(maze, {"floor": 310, "*": 290}, emissivity=0.9, rays=20_000)
        >>> path = heat.save("maze.npz")
        >>> bool((rd.load_exchange(path).net == heat.net).all())
        True
    """
    return read(Path(path), EXCHANGE, (FORMAT, *FORMATS_OF_PANES), _restored)


def _restored(arrays: dict[str, Any], meta: dict[str, Any]) -> RadiativeExchange:
    patches = restored(arrays, meta)
    n, k, bands = len(patches), len(patches.scene.names), len(meta["wavelengths"]) + 1
    shapes = dict.fromkeys(SURFACES, (k,)) | dict.fromkeys(PATCHES, (n,)) | dict.fromkeys(MATRICES, (k + 1, k + 1))
    shapes |= {"emissivity": (k, bands)}
    validate_patches(patches, n)
    for name, shape in shapes.items():
        if arrays[name].shape != shape or arrays[name].dtype != np.float64:
            raise ValueError(f"'{name}' has shape {arrays[name].shape}, expected {shape} of float64")
    if len(meta["conditions"]) != k or len(meta["names"]) != k:
        raise ValueError(f"{len(meta['conditions'])} conditions of {k} surfaces")
    for name, now in (("geometry", patches.scene.geometry_hash), ("cut", patches.cut_hash)):
        if meta["provenance"].get(name, now) != now:
            raise ValueError(f"its {name} is not the one that heat was found in")
    unit, whole = arrays["emissivity"], np.abs(arrays["net"])
    if not (np.isfinite(whole).all() and ((unit > 0) & (unit <= 1) | np.isnan(unit)).all()):
        raise ValueError("heat that is not finite, or emissivities outside (0, 1]")
    for name in ERRORS:
        if (arrays[name] < 0).any():
            raise ValueError(f"'{name}' is negative")
    meta |= {name: tuple(meta[name]) for name in ("names", "conditions", "wavelengths")}
    fields = {name: arrays[name] for name in shapes} | {name: meta[name] for name in (*SCALARS, *REST)}
    return RadiativeExchange(patches=patches, **fields)
