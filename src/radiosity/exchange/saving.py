"""Saving of a radiative exchange: an NPZ archive that stands alone, with the faces and patches it is of."""

import json
from pathlib import Path

import numpy as np

from ..solution.npz import EXCHANGE
from ..solution.stored_patches import stored
from ..solution.whole import whole_file

FORMAT = 1
SURFACES = ("area", "net", "net_standard_error", "temperature", "temperature_standard_error")
PATCHES = ("patch_net", "patch_net_standard_error", "patch_temperature")
MATRICES = ("exchange", "exchange_standard_error")
SCALARS = (
    "surroundings",
    "surroundings_net",
    "surroundings_net_standard_error",
    "rays",
    "replicates",
    "seed",
    "quanta",
    "seconds",
)
REST = ("names", "conditions", "wavelengths", "status", "provenance")


def save(found, path: Path) -> Path:
    """Write the archive whole or not at all.

    Raises:
        OutputError: the file cannot be written.
    """
    arrays, facts = stored(found.patches)
    arrays |= {name: getattr(found, name) for name in ("emissivity", *SURFACES, *PATCHES, *MATRICES)}
    meta = {name: getattr(found, name) for name in (*SCALARS, *REST)}
    arrays["meta"] = np.array(json.dumps(meta | {"kind": EXCHANGE, "format": FORMAT} | facts))
    with whole_file(path) as file:
        np.savez(file, **arrays)
    return path
