"""PLY: faces with their reflectances as linear colours, 64-bit coordinates. Names, emission and sides are not in the format."""

from pathlib import Path

import numpy as np

from ..scene.model import Back, Scene
from ..solution.whole import whole_file
from .pieces import called, tell_of_rest
from .plain import plain
from .told import Told

CORNER, COLOUR = np.dtype("<i4"), np.dtype("<f4")


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file.

    Raises:
        OutputError: it cannot be written.
    """
    tell_of_rest(scene, told, frozenset({"reflectance"}))
    other = (scene.back == Back.RADIATES) & (scene.back_reflectance != scene.reflectance).any(axis=1)
    told.add("backs that reflect otherwise get the reflectance of their fronts", called(scene, other))
    flat = plain(scene, of_surfaces=False)
    colours = np.broadcast_to(flat.reflectance, (flat.n_faces, 3)) if flat.n_bands == 1 else flat.reflectance
    head = [
        "ply",
        "format binary_little_endian 1.0",
        "comment written by radiosity, metres, colours are linear reflectances",
        f"element vertex {len(scene.vertices)}",
        *(f"property double {axis}" for axis in "xyz"),
        f"element face {scene.n_faces}",
        "property list uchar int vertex_indices",
        *(f"property float {band}" for band in ("red", "green", "blue")),
        "end_header",
    ]
    with whole_file(path) as file:
        file.write(("\n".join(head) + "\n").encode("ascii"))
        file.write(np.ascontiguousarray(scene.vertices, "<f8").tobytes())
        for corners, colour in zip(scene.faces, colours.astype(COLOUR), strict=True):
            count = 4 if corners[3] >= 0 else 3
            file.write(bytes([count]) + corners[:count].astype(CORNER).tobytes() + colour.tobytes())
