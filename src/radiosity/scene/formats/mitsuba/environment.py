"""An image of the surroundings (``envmap``) as a sky: the radiance of all directions, y upwards before its transformation.

Mitsuba's rows of pixels reach from pole to pole, and its columns have their middles at halves. Between them radiance is linear in
both angles there; a sky is linear in azimuth and in the sine of the elevation, between rows as many as the image has.
"""

import numpy as np

from ....errors import SceneError
from ...assemble import warn
from ...lights.sky import Sky
from .color import Colors
from .node import Node
from .placement import transformation

MOST = (512, 1024)  # rows and columns of the table
TURNED = 1e-3  # relative: what rounding of a rotation may make


def sky_of_image(node: Node, name: str, colors: Colors) -> Sky:
    """Return the sky of an emitter.

    Raises:
        SceneError: there is no such image, or the transformation is no rotation.
    """
    pixels = colors.bitmap(node).astype(np.float64) * node.number("scale", 1.0)
    height, width = pixels.shape[:2]
    if height < 2:
        raise SceneError(f"{node.place}: the image of '{name}' has {width} x {height} pixels; two rows or more are needed")
    matrix = transformation(node, name)[:3, :3]
    lengths = np.linalg.norm(matrix, axis=0)
    axes = matrix / np.where(lengths > 0, lengths, 1)
    if np.abs(axes.T @ axes - np.eye(3)).max() > TURNED or np.ptp(lengths) > TURNED * lengths.max():
        raise SceneError(f"{node.place}: the transformation of '{name}' is {matrix.tolist()}; it must be a rotation")
    pixels = _smaller(pixels, name, node)
    height, width = pixels.shape[:2]
    half = np.linspace(0, np.pi / 2, (height + 1) // 2)
    elevation = np.concatenate([-half[::-1], half])
    at = (np.pi / 2 - elevation) / np.pi * (height - 1)
    low = np.clip(at.astype(int), 0, height - 2)
    part = (at - low)[:, None, None]
    table = (1 - part) * pixels[low] + part * pixels[low + 1]
    first = np.pi / width  # azimuth of the first column, from -z towards x
    back, right, up = -axes[:, 2], axes[:, 0], axes[:, 1]
    turned = np.stack([np.cos(first) * back + np.sin(first) * right, np.cos(first) * right - np.sin(first) * back, up])
    return Sky(name, table, turned, f"image of {width} x {height} pixels", False)


def _smaller(pixels: np.ndarray, name: str, node: Node) -> np.ndarray:
    """Return an image of at most `MOST` pixels: means of blocks, weighted by solid angle."""
    height, width = pixels.shape[:2]
    rows, columns = -(-height // MOST[0]), -(-width // MOST[1])
    if rows * columns == 1:
        return pixels
    warn(f"{node.place}: the image of '{name}', {width} x {height} pixels, is averaged in blocks of {columns} x {rows}")
    weight = np.sin((np.arange(height) + 0.5) * np.pi / height)[:, None, None]
    top, left = np.arange(0, height, rows), np.arange(0, width, columns)
    sums = np.add.reduceat(np.add.reduceat(pixels * weight, top, axis=0), left, axis=1)
    shares = np.add.reduceat(weight, top, axis=0) * np.diff(np.append(left, width))[:, None]
    return sums / shares
