"""The labyrinth's walls."""

import numpy as np

from .model import Camera, Scene
from .shapes import quad

# inner walls (x0, y0, x1, y1) on the unit grid of a 4 x 4 maze; each is seen from both sides
INNER = ((1, 0, 1, 3), (2, 1, 2, 4), (3, 0, 3, 2), (2, 2, 3, 2), (3, 3, 4, 3), (0, 3, 1, 3))
SEED = 20_000_605


def maze_quads(mean_reflectance: float, cells: int) -> Scene:
    """The scene of `builtin.labyrinth`."""
    if not 0 < mean_reflectance < 1:
        raise ValueError(f"mean_reflectance is {mean_reflectance}; it must be above 0 and strictly below 1")
    if cells < 4:
        raise ValueError(f"cells is {cells}; the maze needs 4 or more")
    n = cells
    outer = [(x, 0, x + 1, 0) for x in range(n)] + [(x + 1, n, x, n) for x in range(n)]
    outer += [(0, y + 1, 0, y) for y in range(n)] + [(n, y, n, y + 1) for y in range(n)]
    inner = []
    for x0, y0, x1, y1 in INNER:
        steps = max(x1 - x0, y1 - y0)
        dx, dy = (x1 - x0) // steps, (y1 - y0) // steps
        inner += [(x0 + dx * s, y0 + dy * s, x0 + dx * (s + 1), y0 + dy * (s + 1)) for s in range(steps)]
    # a wall's front is on the left of its direction; an inner wall is one face that radiates on both sides
    quads = [quad((c, d, 0), (a - c, b - d, 0), (0, 0, 1)) for a, b, c, d in outer + inner]
    names = ["walls"] * len(quads)
    for x in range(n):
        for y in range(n):
            quads += [quad((x, y, 0), (1, 0, 0), (0, 1, 0)), quad((x, y, 1), (0, 1, 0), (1, 0, 0))]
            names += ["floor", "ceiling"]
    two_sided = np.zeros(len(quads), bool)
    two_sided[len(outer) : len(outer) + len(inner)] = True
    # uniform on an interval about the mean, then shifted so that the mean is exact: all sides have 1 m²
    spread = 0.9 * min(mean_reflectance, 1 - mean_reflectance)
    sides = len(quads) + two_sided.sum()
    reflectance = np.random.Generator(np.random.Philox(SEED)).uniform(-spread, spread, sides)
    reflectance += mean_reflectance - reflectance.mean()
    front, back = reflectance[: len(quads)], np.full(len(quads), 0.0)
    back[two_sided] = reflectance[len(quads) :]
    surfaces = ("walls", "floor", "ceiling")
    return Scene.from_arrays(
        np.concatenate(quads),
        np.arange(4 * len(quads)).reshape(-1, 4),
        front,
        1 - front,
        two_sided=two_sided,
        back_reflectance=back,
        back_emission=np.where(two_sided, 1 - back, 0.0),
        surface=[surfaces.index(name) for name in names],
        names=surfaces,
        source=f"labyrinth-{mean_reflectance:g}",
        cameras=(Camera((0.5, 0.15, 0.5), (0.5, 2.0, 0.5), fov=70.0),),
    )
