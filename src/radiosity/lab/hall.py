"""A larger scene for the study: a hall with rows of boxes and many ceiling lights."""

import numpy as np

from ..scene.model import Camera, Scene
from ..scene.shapes import box, join, quad

SIZE, HEIGHT = (24.0, 18.0), 4.0
BOXES, LIGHTS = (8, 6), (6, 4)


def hall() -> Scene:
    """Return a hall of 24 x 18 x 4 m, 48 boxes of heights from a fixed seed, and 24 lights of 60 W/m² just below the ceiling."""
    random = np.random.Generator(np.random.Philox(20))
    boxes = []
    for x, y in _grid(BOXES):
        half, height = random.uniform(0.4, 0.9, 2), random.uniform(0.6, 2.6)
        shape = box((x - half[0], y - half[1], 0), (x + half[0], y + half[1], height), turn=random.uniform(0, 90))
        boxes += [face for at, face in enumerate(shape) if at != 4]  # without the bottom
    lights = [quad((x - 0.6, y + 0.3, HEIGHT - 0.1), (1.2, 0, 0), (0, -0.6, 0)) for x, y in _grid(LIGHTS)]
    walls = box((0, 0, 0), (*SIZE, HEIGHT), inward=True)
    camera = Camera((1.0, 1.0, 2.4), (12.0, 9.0, 1.0), (0, 0, 1), 70.0, 480, 320)
    parts = [
        ("walls", 0.6, 0.0, walls[:4]),
        ("floor", 0.3, 0.0, walls[4:5]),
        ("ceiling", 0.8, 0.0, walls[5:]),
        ("boxes", 0.5, 0.0, boxes),
        ("lights", 0.5, 60.0, lights),
    ]
    return join(parts, source="hall", cameras=(camera,))


def _grid(count: tuple[int, int]):
    """Yield the middles of equal fields of the floor."""
    for i in range(count[0]):
        for j in range(count[1]):
            yield SIZE[0] * (i + 0.5) / count[0], SIZE[1] * (j + 0.5) / count[1]
