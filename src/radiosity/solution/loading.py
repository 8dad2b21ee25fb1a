"""Reading of solution files."""

import json
from pathlib import Path

import numpy as np

from ..errors import SceneError
from ..patches.model import Patches
from ..scene.camera import Camera
from ..scene.model import Scene
from ..scene.paint import Paint
from ..scene.sampler import Sampler
from .archive import check_sizes
from .model import Solution
from .npz import FORMAT, PAINT_ARRAYS, POWER_ARRAYS, SCALARS, SCENE_ARRAYS, SOLUTION_ARRAYS
from .validate import validate

LAST_CHARACTER = 0x10FFFF


def load_solution(path) -> Solution:
    """Read a solution saved by `Solution.save`.

    Raises:
        SceneError: the file is missing, damaged, or no solution.

    Example:
        >>> rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rays=10_000).save("room.npz")
        >>> rd.load_solution("room.npz").status
        'complete'
    """
    path = Path(path)
    try:
        with path.open("rb") as opened:
            check_sizes(opened, path)
            with np.load(opened, allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
        meta = json.loads(_text(arrays["meta"]))
        if meta["format"] != FORMAT:
            raise SceneError(f"{path}: written in format {meta['format']}; this version reads {FORMAT}")
        return _restore(arrays, meta)
    except FileNotFoundError:
        raise SceneError(f"{path}: no such file; solve a scene with -o {path.name} first") from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from None
    except MemoryError:
        raise SceneError(f"{path}: too large for the memory of this machine") from None
    except Exception as error:  # a damaged file of any kind must become a SceneError
        if isinstance(error, SceneError):
            raise
        text = " ".join(str(error).split())[:200]
        raise SceneError(f"{path}: is no solution of this program, or damaged ({text}); solve the scene again") from None


def _text(value: np.ndarray) -> str:
    """Return the text of an array that holds one.

    Numpy takes any four bytes for a character. Bytes that are no character for Python would fail much later.
    """
    native = value.astype(value.dtype.newbyteorder("="))
    if value.dtype.kind != "U" or value.ndim or (np.frombuffer(native.tobytes(), np.uint32) > LAST_CHARACTER).any():
        raise ValueError("meta is no text")
    return str(native)


def _restore(arrays: dict, meta: dict) -> Solution:
    described = meta["scene"]
    paints = {}
    for which, facts in meta["paints"].items():
        images = tuple(arrays[f"{which}_picture_{i}"] for i in range(facts["images"]))
        limit = np.inf if facts["limit"] is None else facts["limit"]
        samplers = tuple(Sampler(tuple(one["wrap"]), one["filter"]) for one in facts.get("samplers", ()))  # older files: none
        held = {name: arrays[f"{which}_{name}"] for name in PAINT_ARRAYS}
        paints[which] = Paint(images, **held, limit=limit, samplers=samplers)
    cameras = tuple(_camera(**fields) for fields in described["cameras"])
    scene = Scene(
        **{name: arrays[f"scene_{name}"] for name in SCENE_ARRAYS},
        **paints,
        cameras=cameras,
        names=tuple(described["names"]),
        bands=tuple(described["bands"]),
        photometric=described["photometric"],
        scale=described["scale"],
        source=described["source"],
    )
    patches = Patches(scene, arrays["patches_columns"], arrays["patches_rows"])
    state = {name[len("state_") :]: value for name, value in arrays.items() if name.startswith("state_")}
    scalars = {name: meta[name] for name in SCALARS}
    scalars["books"] = tuple(scalars["books"])
    scalars |= {"state": state, **{name: arrays.get(name) for name in POWER_ARRAYS}}
    solution = Solution(patches, *(arrays[name] for name in SOLUTION_ARRAYS), **scalars)
    validate(solution)
    return solution


def _camera(origin, target, up, **rest) -> Camera:
    return Camera(tuple(origin), tuple(target), tuple(up), **rest)
