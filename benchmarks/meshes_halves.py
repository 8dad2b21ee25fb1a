"""The best mesh of halves of faces, with the light known: what `meshes_bound.py` compares `radiosity.adapt` with."""

import numpy as np
from meshes_light import Light

import radiosity as rd
from radiosity.patches import Patches
from radiosity.scene.split import split

LEAF = 4  # points of the smallest cell
FINEST = 16  # parts of an edge, of which cuts elsewhere than in the middle leave whole ones on either side


class Tree:
    """All ways to cut a face in halves again and again, and what each cell misses.

    Attributes:
        corners: (4, 2) face coordinates of each node. missed: squared error of each. ways: of each, the ways to cut it, in nodes.
    """

    def __init__(self, light: Light, weight: float, shares: tuple[float, ...] = (0.5,)) -> None:
        self.light, self.weight, self.sides, self.shares = light, weight, light.sides, shares
        self.corners, self.missed, self.ways, self.known = [], [], [], {}
        self.values, self.noise = (x.reshape(len(x), -1).T for x in (light.values, light.noise))
        every = np.arange(light.u.size)
        self.root = self._of(every, 0.0, 0.0, 1.0, 1.0, light.quad)

    def _of(self, some: np.ndarray, u: float, v: float, wide: float, high: float, quad: bool) -> int | None:
        """Return the node of a parallelogram, or of a triangle at the same corner; None where too few points are in it."""
        if len(some) < LEAF:
            return None
        key = (u, v, wide, high, quad)
        if key in self.known:
            return self.known[key]
        values, total = self.values[some], self.light.u.size
        square = (values.var(axis=0, ddof=1) - self.noise[some].mean(axis=0)).sum()
        x, y = self.light.u.ravel()[some], self.light.v.ravel()[some]
        ways, cuts = [], []
        if quad:
            for share in self.shares:
                w, h = wide * share, high * share
                if share == 0.5 or w * FINEST % 1 == 0:
                    left = x < u + w
                    cuts.append([(left, u, v, w, high, True), (~left, u + w, v, wide - w, high, True)])
                if share == 0.5 or h * FINEST % 1 == 0:
                    low = y < v + h
                    cuts.append([(low, u, v, wide, h, True), (~low, u, v + h, wide, high - h, True)])
        else:
            w, h = wide / 2, high / 2
            left, low = x < u + w, y < v + h
            cuts.append([(left & low, u, v, w, h, True), (~left, u + w, v, w, h, False), (~low, u, v + h, w, h, False)])
        for cut in cuts:
            parts = [self._of(some[inside], *rest) for inside, *rest in cut]
            if None not in parts:
                ways.append(parts)
        box = np.array([[0, 0], [1, 0], [1, 1], [0, 1]] if quad else [[0, 0], [1, 0], [0, 1], [0, 1]], float)
        self.corners.append(box * (wide, high) + (u, v))
        self.missed.append(float(square) * self.weight * self.light.area * len(some) / total)
        self.ways.append(ways)
        self.known[key] = len(self.missed) - 1  # the parts of a node come before it
        return self.known[key]

    def best(self, price: float) -> tuple[float, list[int]]:
        """Return the least squared error plus price of all sides, and the nodes of the cells."""
        least, way = [], []
        for missed, ways in zip(self.missed, self.ways, strict=True):
            sums = [missed + price * self.sides, *(sum(least[part] for part in parts) for parts in ways)]
            way.append(int(np.argmin(sums)))
            least.append(sums[way[-1]])
        leaves, open_nodes = [], [self.root]
        while open_nodes:
            node = open_nodes.pop()
            if way[node]:
                open_nodes += reversed(self.ways[node][way[node] - 1])
            else:
                leaves.append(node)
        return least[self.root], leaves


def halved(scene: rd.Scene, trees: list[Tree], count: int) -> tuple[Patches, float]:
    """Return the best mesh of halves with at most so many patches, and its squared error."""
    low, high = -60.0, 10.0  # powers of two of the price
    for _ in range(24):
        middle = (low + high) / 2
        used = sum(len(tree.best(2.0**middle)[1]) * tree.sides for tree in trees)
        low, high = (middle, high) if used > count else (low, middle)
    found = [tree.best(2.0**high)[1] for tree in trees]
    missed = sum(tree.missed[leaf] for tree, leaves in zip(trees, found, strict=True) for leaf in leaves)
    face = np.repeat(np.arange(scene.n_faces), [len(leaves) for leaves in found])
    corners = np.array([tree.corners[leaf] for tree, leaves in zip(trees, found, strict=True) for leaf in leaves])
    cut = split(scene, face, corners)
    one = np.ones(cut.n_faces, np.int32)
    return Patches(cut, one, one), missed
