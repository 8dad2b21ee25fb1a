"""Whether the arrays of a saved solution fit each other, before anything is made of them."""

import numpy as np

LARGEST = 1e60  # of what can be squared, multiplied and summed
FINITE = ("scene_vertices", "scene_emission", "scene_back_emission", "irradiance", "irradiance_standard_error",
          "radiosity", "standard_error")  # fmt: skip


def check(arrays: dict[str, np.ndarray], names: int) -> None:
    """Refuse numbers of vertices, surfaces and patches that do not exist, and values beyond all reason.

    Raises:
        ValueError: what does not fit.
        KeyError, IndexError: an array is missing, or has another number of dimensions.
    """
    for name in FINITE:
        values = arrays[name] if name in arrays else np.zeros(0)
        if values.dtype.kind not in "fiu" or (np.abs(values[np.isfinite(values)]) > LARGEST).any():
            raise ValueError(f"{name} holds values above {LARGEST:g}")
    faces, n = arrays["scene_faces"], len(arrays["scene_vertices"])
    if faces.ndim != 2 or faces.shape[1] != 4 or faces.dtype.kind not in "iu" or arrays["scene_vertices"].shape != (n, 3):
        raise ValueError("faces or vertices of another shape")
    if not len(faces) or faces[:, :3].min() < 0 or faces[:, 3].min() < -1 or faces.max() >= n:
        raise ValueError("a face names a vertex that does not exist")
    if any(len(arrays[f"scene_{name}"]) != len(faces) for name in ("reflectance", "emission", "back", "surface")):
        raise ValueError("values for another number of faces")
    surface = arrays["scene_surface"]
    if surface.dtype.kind not in "iu" or surface.min() < 0 or surface.max() >= names:
        raise ValueError("a face of a surface that does not exist")
    columns, rows = arrays["patches_columns"], arrays["patches_rows"]
    if columns.shape != (len(faces),) or rows.shape != columns.shape or min(columns.min(), rows.min()) < 1:
        raise ValueError("faces cut into no patches")
    if (columns.astype(float) * rows).sum() > 2 * len(arrays["irradiance"]) + len(faces):
        raise ValueError("more patches than results")
