"""VTP files, read back as XML."""

import base64
import io
from xml.etree import ElementTree

import numpy as np
import pytest
from image_samples import quad_scene, solution

import radiosity as rd
from radiosity.image import display_mesh, export
from radiosity.image.plane_fit import at_vertices


def arrays(element):
    result = {}
    for item in element.iter("DataArray"):
        text = item.text.strip()
        (size,) = np.frombuffer(base64.b64decode(text[:12]), "<u8")
        data = base64.b64decode(text[12:])
        assert len(data) == size
        values = np.frombuffer(data, {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8"}[item.get("type")])
        result[item.get("Name")] = values.reshape(-1, int(item.get("NumberOfComponents")))
    return result


@pytest.mark.parametrize("smooth", [True, False])
def test_everything_comes_back(tmp_path, smooth):
    result = solution(rd.subdivide(rd.load_scene("cornell-box"), cells=3))
    export(result, tmp_path / "a.vtp", smooth=smooth)
    piece = ElementTree.parse(tmp_path / "a.vtp").getroot().find("PolyData/Piece")
    n = len(result.patches)
    assert piece.get("NumberOfPolys") == str(n)
    cells = arrays(piece.find("CellData"))
    for name in ("radiosity", "irradiance", "standard_error", "irradiance_standard_error"):
        np.testing.assert_array_equal(cells[name], getattr(result, name))
    np.testing.assert_array_equal(cells["arrivals"][:, 0], np.arange(n))
    np.testing.assert_array_equal(cells["surface"][:, 0], result.patches.surface)
    np.testing.assert_array_equal(cells["area"][:, 0], result.patches.area)
    points, polygons = arrays(piece.find("Points"))["Points"], arrays(piece.find("Polys"))
    assert piece.get("NumberOfPoints") == str(len(points))
    ends = polygons["offsets"][:, 0]
    assert ends[-1] == len(polygons["connectivity"])
    centre = [
        points[polygons["connectivity"][begin:end, 0]].mean(axis=0) for begin, end in zip(np.append(0, ends), ends, strict=False)
    ]
    np.testing.assert_allclose(centre, result.patches.centroid, atol=1e-12)
    smoothed = arrays(piece.find("PointData"))
    assert set(smoothed) == ({"radiosity"} if smooth else set())
    if smooth:
        np.testing.assert_array_equal(
            smoothed["radiosity"], at_vertices(result.patches, display_mesh.build(result.patches), result.radiosity)
        )


def test_names_unit_and_bands_are_field_data(tmp_path):
    result = solution(rd.subdivide(quad_scene(("Wände & <Böden>",)), cells=1), [np.nan], unit="lm/m²")
    export(result, tmp_path / "a.vtp")
    root = ElementTree.parse(tmp_path / "a.vtp").getroot()
    assert root.attrib == {"type": "PolyData", "version": "1.0", "byte_order": "LittleEndian", "header_type": "UInt64"}
    strings = {a.get("Name"): bytes(map(int, a.text.split())).decode().split("\0")[:-1] for a in root.iter("Array")}
    assert strings == {"surface_names": ["Wände & <Böden>"], "bands": ["grey"], "unit": ["lm/m²"]}
    assert np.isnan(arrays(root.find("PolyData/Piece/CellData"))["radiosity"]).all()


def test_long_arrays_are_written_in_pieces(tmp_path, monkeypatch):
    from radiosity.image import vtp

    result = solution(rd.subdivide(quad_scene(), cells=9))
    export(result, tmp_path / "whole.vtp")
    monkeypatch.setattr(vtp, "CHUNK", 30)
    export(result, tmp_path / "pieces.vtp")
    assert (tmp_path / "whole.vtp").read_bytes() == (tmp_path / "pieces.vtp").read_bytes()


@pytest.mark.parametrize("more", [-1, 0, 1])
@pytest.mark.parametrize("pieces", [1, 2])
def test_pieces_join_to_one_text_of_base64(pieces, more):
    """As long as the pieces are: 3 bytes are 4 letters, and none are filled up but the last."""
    from radiosity.image import vtp

    values = np.arange(pieces * vtp.CHUNK // 8 + more)
    file = io.BytesIO()
    vtp._array(file, "x", values)
    text = ElementTree.fromstring(file.getvalue()).text.strip()
    assert len(text) == 12 + 4 * -(-values.nbytes // 3)
    assert base64.b64decode(text[:12], validate=True) == np.array([values.nbytes], "<u8").tobytes()
    assert base64.b64decode(text[12:], validate=True) == values.tobytes()
