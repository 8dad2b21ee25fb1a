"""Saving of a radiative exchange: an NPZ archive that stands alone, with the faces and patches it is of."""

import json
from pathlib import Path

import numpy as np

from ..solution.npz import SCENE_ARRAYS
from ..solution.whole import whole_file

KIND, FORMAT = "radiative exchange", 1
SURFACES = ("area", "net", "net_standard_error", "temperature", "temperature_standard_error")
PATCHES = ("patch_net", "patch_net_standard_error", "patch_temperature")
MATRICES = ("exchange", "exchange_standard_error")
SCALARS = ("surroundings", "surroundings_net", "surroundings_net_standard_error", "rays", "replicates", "seed", "seconds")
REST = ("names", "conditions", "wavelengths", "status", "provenance")


def save(found, path: Path) -> Path:
    """Write the archive whole or not at all.

    Raises:
        OutputError: the file cannot be written.
    """
    scene, patches = found.patches.scene, found.patches
    arrays = {f"scene_{name}": getattr(scene, name) for name in SCENE_ARRAYS}
    arrays |= {"patches_columns": patches.columns, "patches_rows": patches.rows, "emissivity": found.emissivity}
    arrays |= {name: getattr(found, name) for name in (*SURFACES, *PATCHES, *MATRICES)}
    meta = {name: getattr(found, name) for name in (*SCALARS, *REST)}
    described = {"bands": scene.bands, "scale": scene.scale, "source": scene.source}
    arrays["meta"] = np.array(json.dumps(meta | {"kind": KIND, "format": FORMAT, "scene": described}))
    with whole_file(path) as file:
        np.savez(file, **arrays)
    return path
