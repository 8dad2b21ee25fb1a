"""Discretisation errors where the light is known: a small lamp, and a board that is turned by 30 degrees over a floor.

All but the floor of 4 x 4 m is black, so its light comes from the lamp alone: 256 points of the lamp, each seen or hidden by the
board, exactly. The error of a mesh is the RMS over the floor of (light at a point) less (its mean over the patch), relative to
the RMS of light, from 64 points of each patch. "pilots" are meshes that follow the light without cuts along edges of shadows.

python benchmarks/shadows.py [--lamps 0.02 0.1 0.4] [--patches 300 1000 3000]
"""

import argparse

import numpy as np

import radiosity as rd
from radiosity.run import adapt

MIDDLE, LAMP, HEIGHT = (2.1, 1.9), (1.8, 2.0, 2.5), 1.0
TURN = np.radians(30)
AXES = np.array([[np.cos(TURN), np.sin(TURN)], [-np.sin(TURN), np.cos(TURN)]])
HALF = (0.6, 0.35)  # of the board's edges
SQUARE = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
ROW = "{:>8} {:>8} {:>8} {:>8} {:>8} {:>8}"


def board_over_floor(edge: float) -> rd.Scene:
    """The scene; the lamp's edges in metres."""
    floor = np.column_stack([2 + 2 * SQUARE, np.zeros(4)])
    board = np.column_stack([SQUARE * HALF @ AXES + MIDDLE, np.full(4, HEIGHT)])
    lamp = np.column_stack([SQUARE[::-1] * edge / 2, np.zeros(4)]) + LAMP
    return rd.Scene.from_arrays(
        np.concatenate([floor, board, lamp]),
        np.arange(12).reshape(3, 4),
        [0.5, 0, 0],
        [0, 0, 100 / edge**2],
        surface=range(3),
        names=["floor", "board", "lamp"],
    )


def light(points: np.ndarray, edge: float, n: int = 16) -> np.ndarray:
    """The light at points of the floor, (m, 2), up to a factor."""
    total = np.zeros(len(points))
    steps = ((np.arange(n) + 0.5) / n - 0.5) * edge
    for x in steps:
        for y in steps:
            way = np.array([LAMP[0] + x, LAMP[1] + y]) - points
            at = np.abs((points + way * (HEIGHT / LAMP[2]) - MIDDLE) @ AXES.T)
            total += (at > HALF).any(axis=1) / ((way**2).sum(axis=1) + LAMP[2] ** 2) ** 2
    return total


def error(patches: rd.Patches, edge: float, n: int = 8) -> float:
    """The RMS of what patches miss of the light of the floor, relative."""
    floor = np.flatnonzero(patches.surface == 0)
    corners = patches.corners[floor][:, :, None, :2]
    u, v = (x.ravel()[:, None] for x in np.meshgrid(*[(np.arange(n) + 0.5) / n] * 2))
    over = (corners[:, 2] == corners[:, 3]).all(axis=2)[:, :, None] & (u + v > 1)
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    points = corners[:, 0] + u * (corners[:, 1] - corners[:, 0]) + v * (corners[:, 3] - corners[:, 0])
    found, area = light(points.reshape(-1, 2), edge).reshape(len(floor), -1), patches.area[floor]
    return float(np.sqrt((area @ found.var(axis=1)) / (area @ (found**2).mean(axis=1))))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lamps", nargs="+", type=float, default=[0.02, 0.1, 0.4])
    parser.add_argument("--patches", nargs="+", type=int, default=[300, 1000, 3000])
    given = parser.parse_args()
    print(ROW.format("lamp m", "patches", "even", "pilots", "shadows", "ratio"))
    share = adapt.SHADOWS
    for lamp_edge in given.lamps:
        scene = board_over_floor(lamp_edge)
        for count in given.patches:
            meshes = [rd.subdivide(scene, about=count)]
            for adapt.SHADOWS in (10**9, share):
                meshes.append(rd.adapt(scene, count))
            missed = [error(mesh, lamp_edge) for mesh in meshes]
            told = [f"{value:.2%}" for value in missed]
            print(ROW.format(lamp_edge, len(meshes[2]), *told, f"{missed[1] / missed[2]:.2f}"), flush=True)
