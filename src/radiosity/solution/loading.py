"""Reading of solution files."""

from pathlib import Path
from typing import Any

from .model import Solution
from .npz import (
    BASIS_ARRAYS,
    FORMAT,
    FORMAT_OF_LIGHTS,
    FORMAT_OF_OWN,
    FORMATS_OF_PANES,
    POWER_ARRAYS,
    SCALARS,
    SOLUTION,
    SOLUTION_ARRAYS,
    WARNINGS,
)
from .reading import read
from .stored_patches import restored
from .validate import validate


def load_solution(path) -> Solution:
    """Read a solution saved by `Solution.save`.

    Raises:
        SceneError: the file is missing, damaged, or no solution.

    Example:
        >>> rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rays=10_000).save("room.npz")
        >>> rd.load_solution("room.npz").status
        'complete'
    """
    return read(Path(path), SOLUTION, (FORMAT, FORMAT_OF_OWN, FORMAT_OF_LIGHTS, *FORMATS_OF_PANES), _restore)


def _restore(arrays: dict[str, Any], meta: dict[str, Any]) -> Solution:
    patches = restored(arrays, meta)
    state = {name[len("state_") :]: value for name, value in arrays.items() if name.startswith("state_")}
    scalars = {name: meta[name] for name in SCALARS}
    scalars["books"] = tuple(scalars["books"])
    scalars[WARNINGS] = tuple(meta.get(WARNINGS, ()))
    scalars |= {"state": state, **{name: arrays.get(name) for name in (*POWER_ARRAYS, *BASIS_ARRAYS)}}
    solution = Solution(patches, *(arrays[name] for name in SOLUTION_ARRAYS), **scalars)
    validate(solution)
    return solution
