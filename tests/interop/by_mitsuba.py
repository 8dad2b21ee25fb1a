"""Mitsuba as the second reader: of its own scenes, and of the geometry of OBJ and PLY files."""

import numpy as np

from .record import Reading, Refused, surface


def mesh(path) -> Reading:
    """One surface of the whole file."""
    try:
        shape = _mitsuba().load_dict({"type": path.suffix[1:], "filename": str(path), "face_normals": True})
    except RuntimeError as error:
        raise Refused(str(error)) from None
    return {"all": surface(_triangles(shape))}


def _triangles(shape) -> np.ndarray:
    faces = np.array(shape.faces_buffer()).reshape(-1, 3)
    return np.array(shape.vertex_positions_buffer(), float).reshape(-1, 3)[faces]


def _mitsuba():
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    return mitsuba
