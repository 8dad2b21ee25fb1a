"""Loading of a saved radiative exchange."""

import json
from pathlib import Path

import numpy as np

from ..errors import SceneError
from ..patches.model import Patches
from ..scene.model import Scene
from ..solution.archive import check_sizes
from ..solution.npz import SCENE_ARRAYS
from .result import RadiativeExchange
from .saving import FORMAT, KIND, MATRICES, PATCHES, REST, SCALARS, SURFACES


def load_exchange(path) -> RadiativeExchange:
    """Read a radiative exchange saved by `RadiativeExchange.save`.

    Raises:
        SceneError: the file is missing, damaged, or something else.
    """
    path = Path(path)
    try:
        with path.open("rb") as opened:
            check_sizes(opened, path)
            with np.load(opened, allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
        meta = json.loads(str(arrays["meta"]))
        if meta.get("kind") != KIND or meta["format"] != FORMAT:
            raise SceneError(f"{path}: holds {meta.get('kind', 'a solution')!r}, not a {KIND} of format {FORMAT}")
        return _restored(arrays, meta, path)
    except FileNotFoundError:
        raise SceneError(f"{path}: no such file; `radiosity exchange SCENE -o {path.name}` writes one") from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from None
    except MemoryError:
        raise SceneError(f"{path}: too large for the memory of this machine") from None
    except Exception as error:  # a damaged file of any kind must become a SceneError
        if isinstance(error, SceneError):
            raise
        text = " ".join(str(error).split())[:200]
        raise SceneError(f"{path}: is no {KIND} of this program, or damaged ({text}); make it again") from None


def _restored(arrays: dict, meta: dict, path: Path) -> RadiativeExchange:
    described, names = meta["scene"], tuple(str(name) for name in meta["names"])
    scene = Scene(
        **{name: arrays[f"scene_{name}"] for name in SCENE_ARRAYS},
        names=names,
        bands=tuple(described["bands"]),
        scale=float(described["scale"]),
        source=str(described["source"]),
    )
    patches = Patches(scene, arrays["patches_columns"], arrays["patches_rows"])
    n, k, bands = len(patches), len(names), len(meta["wavelengths"]) + 1
    shapes = dict.fromkeys(SURFACES, (k,)) | dict.fromkeys(PATCHES, (n,)) | dict.fromkeys(MATRICES, (k + 1, k + 1))
    shapes |= {"emissivity": (k, bands)}
    for name, shape in shapes.items():
        if arrays[name].shape != shape or arrays[name].dtype != np.float64:
            raise SceneError(f"{path}: '{name}' has shape {arrays[name].shape}, expected {shape} of float64; the file is damaged")
    if len(meta["conditions"]) != k:
        raise SceneError(f"{path}: {len(meta['conditions'])} conditions of {k} surfaces; the file is damaged")
    meta |= {"names": names, "conditions": tuple(meta["conditions"]), "wavelengths": tuple(meta["wavelengths"])}
    fields = {name: arrays[name] for name in shapes} | {name: meta[name] for name in (*SCALARS, *REST)}
    return RadiativeExchange(patches=patches, **fields)
