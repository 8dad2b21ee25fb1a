"""The scene `studio`: a furnished room in colour, which ``make demo`` shows.

All edges lie on a grid of 10 cm, so that patches of that size end at furniture, and none lies half under it.
"""

from dataclasses import replace

import numpy as np

from .camera import Camera
from .model import Scene
from .shapes import box, quad

GRID = 0.1  # m
PANEL, LANTERN = (40.0, 41.0, 42.0), (34.0, 15.0, 4.0)  # W/m²
CREAM, WHITE, OAK = (0.78, 0.77, 0.73), (0.84, 0.84, 0.83), (0.48, 0.36, 0.25)
TERRACOTTA, TEAL, MUSTARD, PINE = (0.66, 0.25, 0.15), (0.12, 0.42, 0.50), (0.80, 0.58, 0.10), (0.70, 0.56, 0.38)
BLACK = (0.0, 0.0, 0.0)


def studio() -> Scene:
    """A room of 4 x 4 x 2.6 m with a lamp under the ceiling and a lantern on the table."""
    walls = box((0, 0, 0), (4, 4, 2.6), inward=True)
    names = ("south wall", "north wall", "west wall", "east wall", "floor", "ceiling")
    colors = (CREAM, CREAM, TERRACOTTA, TEAL, OAK, WHITE)
    parts = [(name, color, BLACK, [face]) for name, color, face in zip(names, colors, walls, strict=True)]
    legs = [box((x, y, 0), (x + 0.1, y + 0.1, 0.7))[:4] for x in (1.9, 3.1) for y in (1.9, 2.7)]
    parts += [
        ("table", PINE, BLACK, [*(face for leg in legs for face in leg), *box((1.8, 1.8, 0.7), (3.3, 2.9, 0.8))]),
        ("lantern", BLACK, LANTERN, standing((2.8, 2.4, 0.8), (3.0, 2.6, 1.1))),
        ("shelf", WHITE, BLACK, standing((0.2, 3.3, 0), (1.2, 3.9, 1.7))),
        ("stool", MUSTARD, BLACK, standing((0.8, 1.5, 0), (1.4, 2.1, 0.5))),
        ("chest", TEAL, BLACK, standing((2.9, 3.3, 0), (3.9, 3.9, 0.9))),
        ("lamp", WHITE, PANEL, [quad((1.5, 2.2, 2.58), (0, 0.6, 0), (1.0, 0, 0))]),
    ]
    rows = [(i, color, emission, corners) for i, (_, color, emission, quads) in enumerate(parts) for corners in quads]
    lamp = np.array([parts[i][0] == "lamp" for i, *_ in rows])
    scene = Scene.from_arrays(
        np.concatenate([corners for *_, corners in rows]),
        np.arange(4 * len(rows)).reshape(-1, 4),
        np.array([color for _, color, _, _ in rows]),
        np.array([emission for _, _, emission, _ in rows]),
        surface=[i for i, *_ in rows],
        names=[name for name, *_ in parts],
        two_sided=lamp,
        back_emission=np.zeros((1, 3)),
        cameras=(Camera((1.8, 0.05, 1.55), (2.05, 3.0, 1.12), (0, 0, 1), 68.0, 800, 600),),
        source="studio",
    )
    return replace(scene, patch_size=np.full(len(parts), GRID))


def standing(low, high) -> list[np.ndarray]:
    """The faces of a box without its bottom, on which it stands."""
    faces = box(low, high)
    return [*faces[:4], faces[5]]
