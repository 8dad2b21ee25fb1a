"""Writing of solution files."""

import json
from pathlib import Path

import numpy as np

from .npz import (
    BASIS_ARRAYS,
    FORMAT,
    FORMAT_OF_LIGHTS,
    FORMAT_OF_OWN,
    OWN_ARRAYS,
    POWER_ARRAYS,
    SCALARS,
    SOLUTION_ARRAYS,
    WARNINGS,
)
from .stored_patches import stored
from .whole import whole_file


def save(solution, path: Path, *, derived: bool = True) -> None:
    """Write ``path``; a failed write leaves the old file as it was.

    Args:
        solution: the `Solution` to write.
        path: the file to write.
        derived: write also arrays that follow from the others, for other programs that read the file.

    Raises:
        OutputError: the file cannot be written.
    """
    arrays, facts = stored(solution.patches)
    arrays |= {name: getattr(solution, name) for name in SOLUTION_ARRAYS}
    arrays |= {name: getattr(solution, name) for name in (*POWER_ARRAYS, *BASIS_ARRAYS) if getattr(solution, name) is not None}
    if derived:
        arrays |= {"radiosity": solution.radiosity, "standard_error": solution.standard_error}
    arrays |= {f"state_{name}": value for name, value in solution.state.items()}
    meta = {name: getattr(solution, name) for name in (*SCALARS, WARNINGS)}
    own = any(f"patches_{name}" in arrays for name in OWN_ARRAYS)
    lit = bool(solution.patches.scene.lights)
    meta |= {"format": FORMAT_OF_LIGHTS if lit else FORMAT_OF_OWN if own else FORMAT, **facts}
    arrays["meta"] = np.array(json.dumps(meta))
    with whole_file(path) as file:
        np.savez(file, **arrays)
