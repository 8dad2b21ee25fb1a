"""Writing of solution files."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from .npz import FORMAT, PAINT_ARRAYS, POWER_ARRAYS, SCALARS, SCENE_ARRAYS, SOLUTION_ARRAYS
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
    scene, patches = solution.patches.scene, solution.patches
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
    arrays |= {name: getattr(solution, name) for name in SOLUTION_ARRAYS}
    arrays |= {name: getattr(solution, name) for name in POWER_ARRAYS if getattr(solution, name) is not None}
    if derived:
        arrays |= {"radiosity": solution.radiosity, "standard_error": solution.standard_error}
    arrays |= {f"state_{name}": value for name, value in solution.state.items()}
    meta = {name: getattr(solution, name) for name in SCALARS}
    meta |= {
        "format": FORMAT,
        "paints": paints,
        "scene": {
            "names": scene.names,
            "bands": scene.bands,
            "photometric": scene.photometric,
            "scale": scene.scale,
            "source": scene.source,
            "cameras": [asdict(c) for c in scene.cameras],
        },
    }
    arrays["meta"] = np.array(json.dumps(meta))
    with whole_file(path) as file:
        np.savez(file, **arrays)
