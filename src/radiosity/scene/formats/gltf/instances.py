"""EXT_mesh_gpu_instancing: a node that shows its mesh many times."""

import numpy as np

from .accessor import accessor
from .file import GltfFile
from .nodes import local_matrix

NAME = "EXT_mesh_gpu_instancing"
WIDTHS = {"TRANSLATION": 3, "ROTATION": 4, "SCALE": 3}
MOST = 1_000_000  # instances of a node


def placements(file: GltfFile, info: dict, matrix: np.ndarray, name: str) -> list[np.ndarray]:
    """The (4, 4) transforms to the world under which a node shows its mesh: ``matrix`` alone without the extension.

    Raises:
        SceneError: the extension's attributes do not fit each other, or are too many.
    """
    what = f"{NAME} of '{name}'"
    extensions = file.dictionary(info.get("extensions", {}), f"extensions of '{name}'")
    if NAME not in extensions:
        return [matrix]
    given = file.dictionary(file.dictionary(extensions[NAME], what).get("attributes"), f"attributes of {what}")
    columns = {key.lower(): accessor(file, given[key]).astype(np.float64) for key in WIDTHS if key in given}
    counts = {len(values) for values in columns.values()}
    for key, width in WIDTHS.items():
        if key in given and columns[key.lower()].shape[1] != width:
            raise file.fail(f"{key} of {what} has {columns[key.lower()].shape[1]} numbers an instance; expected {width}")
    if len(counts) != 1 or max(counts) > MOST:
        raise file.fail(f"{what} has {sorted(counts)} instances; its attributes must have one count, at most {MOST}")
    rows = ({key: values[i].tolist() for key, values in columns.items()} for i in range(counts.pop()))
    return [matrix @ local_matrix(file, row, f"instance {i} of '{name}'") for i, row in enumerate(rows)]
