"""STL, binary: triangles in 32-bit coordinates, and nothing else."""

from pathlib import Path

import numpy as np

from ..scene.model import Scene, unit_normals
from ..solution.whole import whole_file
from .pieces import tell_of_rest, triangles
from .rounding import tell_of_rounding
from .told import Told

HEAD = 80  # bytes
ROW = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file.

    Raises:
        OutputError: it cannot be written.
    """
    tell_of_rest(scene, told, frozenset())
    halves = triangles(scene.faces)
    points = scene.vertices[np.take_along_axis(scene.faces[halves[:, 0]], halves[:, 1:], axis=1)]
    tell_of_rounding(told, scene.names, scene.surface[halves[:, 0]], points)
    rows = np.zeros(len(points), ROW)
    rows["corners"] = points
    rows["normal"] = unit_normals(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    with whole_file(path) as file:
        file.write(b"written by radiosity, metres".ljust(HEAD))
        file.write(np.uint32(len(rows)).astype("<u4").tobytes() + rows.tobytes())
