"""VTP: VTK's XML PolyData (version 1.0, base64), for ParaView and PyVista.

There is one polygon for each patch. Cell data are radiosity, irradiance, their standard errors (NaN where unknown), arrivals,
surface number and area. Point data are radiosity smoothed within surfaces. Field data are surface names, bands and unit.
"""

import base64
from xml.sax.saxutils import quoteattr

import numpy as np

from ..solution.replacing import replacing
from . import display_mesh
from .look import Look
from .polynomial_light import own_values, vertex_values
from .quantity import choose

TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "i8": "Int64", "u1": "UInt8"}
CHUNK = 3 << 20  # bytes; a multiple of 3, so that base64 can be written piece by piece
PER_PATCH = ("radiosity", "irradiance", "standard_error", "irradiance_standard_error")


def write(solution, path, look: Look) -> None:
    """Write a VTP file. Without ``look.smooth`` each patch has vertices of its own, and there is point data only of
    polynomials (`radiosity.patches.bases`)."""
    patches = solution.patches
    mesh = display_mesh.build(patches)
    shown, points = choose(solution), {}
    if look.smooth:
        points["radiosity"] = vertex_values(patches, mesh, shown)
    else:
        whole, (mesh, owner) = mesh, mesh.flat()
        if shown.light is not None:
            points["radiosity"] = own_values(whole, owner, shown)
    used = np.ones(mesh.polygons.shape, bool)
    used[:, 3] = mesh.is_quad
    cells = {name: np.asarray(getattr(solution, name), np.float64) for name in PER_PATCH}
    cells["arrivals"] = np.asarray(solution.arrivals)
    cells["surface"], cells["area"] = mesh.surface, patches.area
    bands = [str(band) for band in solution.bands]
    with replacing(path) as temporary, temporary.open("wb") as file:
        file.write(
            b'<?xml version="1.0"?>\n<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        )
        file.write(b"<PolyData>\n<FieldData>\n")
        for name, strings in (("surface_names", patches.scene.names), ("bands", bands), ("unit", [solution.unit])):
            codes = " ".join(str(code) for text in strings for code in (*text.encode("utf-8", "replace"), 0))
            file.write(
                f'<Array type="String" Name="{name}" NumberOfTuples="{len(strings)}" format="ascii">{codes}</Array>\n'.encode()
            )
        file.write(f'</FieldData>\n<Piece NumberOfPoints="{len(mesh.vertices)}" NumberOfPolys="{len(mesh.polygons)}">\n'.encode())
        file.write(b"<Points>\n")
        _array(file, "Points", mesh.vertices.astype("<f8"))
        file.write(b"</Points>\n<Polys>\n")
        _array(file, "connectivity", mesh.polygons[used].astype("<i8"))
        _array(file, "offsets", np.cumsum(used.sum(axis=1)).astype("<i8"))
        file.write(b"</Polys>\n")
        for tag, data in (("PointData", points), ("CellData", cells)):
            file.write(f'<{tag} Scalars="radiosity">\n'.encode() if data else f"<{tag}>\n".encode())
            for name, values in data.items():
                _array(file, name, values, bands)
            file.write(f"</{tag}>\n".encode())
        file.write(b"</Piece>\n</PolyData>\n</VTKFile>\n")


def _array(file, name: str, values: np.ndarray, bands=()) -> None:
    values = np.ascontiguousarray(values)
    values = (
        values.astype("<i8") if values.dtype.str[1:] not in TYPES else values.astype(values.dtype.newbyteorder("<"), copy=False)
    )
    columns = values.shape[1] if values.ndim == 2 else 1
    labels = (
        "".join(f" ComponentName{i}={quoteattr(band)}" for i, band in enumerate(bands))
        if columns == len(bands) and columns > 1
        else ""
    )
    kind = TYPES[values.dtype.str[1:]]
    file.write(
        f'<DataArray type="{kind}" Name={quoteattr(name)} NumberOfComponents="{columns}"{labels} format="binary">\n'.encode()
    )
    file.write(base64.b64encode(np.array([values.nbytes], "<u8").tobytes()))
    data = values.reshape(-1).view(np.uint8) if values.size else np.zeros(0, np.uint8)
    for begin in range(0, len(data), CHUNK):
        file.write(base64.b64encode(data[begin : begin + CHUNK].tobytes()))
    file.write(b"\n</DataArray>\n")
