"""numpy-stl as the second reader of STL, which tells solids apart by name."""

import warnings

import numpy as np

from .record import Reading, Refused, surface


def read(path) -> Reading:
    from stl import Mode, mesh

    data = path.read_bytes()
    binary = b"facet normal" not in data.lower() and len(data) >= 84 + 50 * int.from_bytes(data[80:84], "little")
    mode = Mode.BINARY if binary else Mode.ASCII
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            one, several = mesh.Mesh.from_file, mesh.Mesh.from_multi_file
            parts = [one(str(path), mode=mode)] if binary else list(several(str(path), mode=mode))
        except Exception as error:  # of many classes
            raise Refused(f"{type(error).__name__}: {error}") from None
    result = {}
    for part in parts:
        name = path.stem if binary else part.name.decode() if isinstance(part.name, bytes) else str(part.name)
        result[name or path.stem] = surface(np.asarray(part.vectors, float))
    return result
