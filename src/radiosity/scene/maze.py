"""The labyrinth's walls."""

import numpy as np

from .model import Camera, Scene
from .shapes import quad

# inner walls (x0, y0, x1, y1) on the unit grid of a 4 x 4 maze; each is seen from both sides
INNER = ((1, 0, 1, 3), (2, 1, 2, 4), (3, 0, 3, 2), (2, 2, 3, 2), (3, 3, 4, 3), (0, 3, 1, 3))
SEED = 20_000_605


def maze_quads(mean_reflectance: float, cells: int) -> Scene:
    """See `builtin.labyrinth`."""
    if not 0 < mean_reflectance < 1:
        raise ValueError(f"mean_reflectance is {mean_reflectance}; it must lie between 0 and 1")
    if cells < 4:
        raise ValueError(f"cells is {cells}; the maze needs 4 or more")
    n = cells
    walls = [(x, 0, x + 1, 0) for x in range(n)] + [(x + 1, n, x, n) for x in range(n)]
    walls += [(0, y + 1, 0, y) for y in range(n)] + [(n, y, n, y + 1) for y in range(n)]
    for x0, y0, x1, y1 in INNER:
        steps = max(x1 - x0, y1 - y0)
        along = [(x0 + (x1 - x0) * s / steps, y0 + (y1 - y0) * s / steps) for s in range(steps + 1)]
        for (a, b), (c, d) in zip(along, along[1:], strict=False):
            walls += [(a, b, c, d), (c, d, a, b)]
    # a wall's front is on the left of its direction
    quads = [quad((a, b, 0), (c - a, d - b, 0), (0, 0, 1))[[1, 0, 3, 2]] for a, b, c, d in walls]
    names = ["walls"] * len(quads)
    for x in range(n):
        for y in range(n):
            quads.append(quad((x, y, 0), (1, 0, 0), (0, 1, 0)))
            quads.append(quad((x, y, 1), (0, 1, 0), (1, 0, 0)))
            names += ["floor", "ceiling"]
    # uniform over the widest interval about the mean, then shifted so that the mean is exact (all faces are 1 m²)
    spread = 0.9 * min(mean_reflectance, 1 - mean_reflectance)
    offset = np.random.Generator(np.random.Philox(SEED)).uniform(-spread, spread, len(quads))
    reflectance = mean_reflectance + offset - offset.mean()
    surfaces = ("walls", "floor", "ceiling")
    return Scene.from_arrays(
        np.concatenate(quads), np.arange(4 * len(quads)).reshape(-1, 4), reflectance, 1 - reflectance,
        surface=[surfaces.index(name) for name in names], names=surfaces,
        source=f"labyrinth-{mean_reflectance:g}", cameras=(Camera((0.5, 0.15, 0.5), (0.5, 2.0, 0.5), fov=70.0),),
    )  # fmt: skip
