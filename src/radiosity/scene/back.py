"""Backs of faces, and what they do to lines that hit them."""

from enum import IntEnum


class Back(IntEnum):
    """What the back of a face does.

    Example:
        >>> corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        >>> scene = rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], reflectance=0.5, emission=1, back=[rd.Back.PASSES])
        >>> rd.Back(scene.back[0]).name
        'PASSES'
    """

    ABSORBS = 0
    RADIATES = 1
    PASSES = 2  # invisible from behind: lines pass through
    OPEN = 3  # a lamp that hides nothing: lines pass through from both sides, and the front emits
