"""IFC models: classes, names, styles, windows, openings, spaces and mirrored items. ifcopenshell writes the file that is read."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.scene.formats.ifc import Reader, is_glass, run
from radiosity.scene.formats.ifc.run import Product
from radiosity.scene.formats.ifc.shells import mended

BOX = np.array(
    [
        (0, 3, 2),
        (0, 2, 1),
        (4, 5, 6),
        (4, 6, 7),
        (0, 1, 5),
        (0, 5, 4),
        (1, 2, 6),
        (1, 6, 5),
        (2, 3, 7),
        (2, 7, 6),
        (3, 0, 4),
        (3, 4, 7),
    ]
)


def box(low, high):
    """Corners of a box whose triangles are `BOX`, with fronts outside."""
    (a, b, c), (d, e, f) = low, high
    return np.array([(x, y, z) for z in (c, f) for x, y in ((a, b), (d, b), (d, e), (a, e))], float)


def volume(vertices, triangles):
    points = vertices[triangles]
    return np.einsum("ij,ij->i", points[:, 0], np.cross(points[:, 1], points[:, 2])).sum() / 6


def test_a_mirrored_shell_is_turned_and_others_stay():
    vertices = np.concatenate([box((0, 0, 0), (1, 2, 3)), box((5, 0, 0), (6, 1, 1)) * (-1, 1, 1)])
    triangles = np.concatenate([BOX, BOX + 8])
    result, closed, turned = mended(vertices, triangles)
    assert turned == 1
    assert closed.all()
    assert volume(vertices, result) == pytest.approx(6 + 1)
    np.testing.assert_array_equal(result[:12], triangles[:12])


@pytest.mark.parametrize("mirror", [1, -1])
def test_the_wall_of_a_cavity_looks_into_the_cavity(mirror):
    inner = BOX[:, ::-1] + 8
    vertices = np.concatenate([box((0, 0, 0), (3, 3, 3)), box((1, 1, 1), (2, 2, 2))]) * (mirror, 1, 1)
    result, _, turned = mended(vertices, np.concatenate([BOX, inner]))
    assert volume(vertices, result) == pytest.approx(27 - 1)
    assert turned == (0 if mirror == 1 else 2)


def test_an_open_shell_is_left_as_it_is():
    result, closed, turned = mended(box((0, 0, 0), (1, 1, 1)), BOX[:-1, ::-1])
    np.testing.assert_array_equal(result, BOX[:-1, ::-1])
    assert not closed.any()
    assert turned == 0


def test_styles_of_a_product_are_surfaces_and_glass_is_a_pane():
    styles = (
        {"name": "Frame", "color": [0.5, 0.5, 0.5], "transparency": None},
        {"name": "Clear Glass", "color": [1, 1, 1], "transparency": None},
    )
    vertices = np.concatenate([box((0, 0, 0), (1, 1, 1)), box((2, 0, 0), (3, 1, 1))])
    product = Product("IfcWindow", "A", (), styles, vertices, np.concatenate([BOX, BOX + 8]), np.repeat([0, 1], 12))
    reader = Reader()
    reader.add(product)
    frame, glass = reader.parts
    assert [frame.name, glass.name] == ["IfcWindow/A/Frame", "IfcWindow/A/Clear Glass"]
    assert frame.material.reflectance == pytest.approx((((0.5 + 0.055) / 1.055) ** 2.4,))  # sRGB
    assert frame.material.back == rd.Back.ABSORBS
    assert glass.material.transmittance**2 == pytest.approx(0.807, abs=0.001)  # light crosses two faces of the solid pane
    assert not reader.opaque


def test_a_window_without_a_transparent_part_is_told():
    reader = Reader()
    styles = ({"name": None, "color": None, "transparency": None},)
    reader.add(Product("IfcWindow", "A", ("Wood",), styles, box((0, 0, 0), (1, 1, 1)), BOX, np.zeros(12, int)))
    assert list(reader.opaque) == ["IfcWindow/A"]
    assert [part.name for part in reader.parts] == ["IfcWindow/A/Wood"]


def test_names_of_insulation_are_not_names_of_glass():
    found = [is_glass(name) for name in ("Glas, klar", "VERRE 6mm", "Glass Wool", "Fiberglass", "Glasfaser", "Oak", None)]
    assert found == [True, True, False, False, False, False, False]


def written(path):
    """A wall with an opening and a window in it, a space, and a mirrored item, in millimetres."""
    ifc = pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed: pip install 'radiosity[ifc]'")
    file = ifc.file(schema="IFC4")
    new = file.create_entity
    numbers = iter(range(10_000))

    def rooted(kind, **values):
        return new(kind, GlobalId=f"{next(numbers):022d}", **values)

    def point(*values):
        return new("IfcCartesianPoint", tuple(map(float, values)))

    def brep(low, high):
        points = [point(*corner) for corner in 1000 * box(low, high)]
        rings = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
        faces = [
            new("IfcFace", [new("IfcFaceOuterBound", new("IfcPolyLoop", [points[i] for i in ring]), True)]) for ring in rings
        ]
        return new("IfcFacetedBrep", new("IfcClosedShell", faces))

    origin = new("IfcAxis2Placement3D", point(0, 0, 0))
    context = new(
        "IfcGeometricRepresentationContext",
        ContextType="Model",
        CoordinateSpaceDimension=3,
        Precision=1e-5,
        WorldCoordinateSystem=origin,
    )
    body = new(
        "IfcGeometricRepresentationSubContext",
        ContextIdentifier="Body",
        ContextType="Model",
        ParentContext=context,
        TargetView="MODEL_VIEW",
    )
    units = new("IfcUnitAssignment", [new("IfcSIUnit", UnitType="LENGTHUNIT", Prefix="MILLI", Name="METRE")])
    rooted("IfcProject", RepresentationContexts=[context], UnitsInContext=units)

    def product(kind, name, item, how="Brep"):
        shape = new("IfcShapeRepresentation", body, "Body", how, [item])
        place = new("IfcLocalPlacement", RelativePlacement=origin)
        return rooted(
            kind, Name=name, ObjectPlacement=place, Representation=new("IfcProductDefinitionShape", Representations=[shape])
        )

    def styled(item, name, color, transparency):
        shading = new("IfcSurfaceStyleShading", new("IfcColourRgb", None, *color), transparency)
        new("IfcStyledItem", item, [new("IfcSurfaceStyle", name, "BOTH", [shading])])

    solid, pane = brep((0, 0, 0), (4, 0.2, 3)), brep((1, 0.09, 1), (2, 0.11, 2))
    styled(solid, "paint", (0.5, 0.5, 0.5), None)
    styled(pane, "pane", (0.9, 1.0, 0.9), 0.7)
    wall, opening = product("IfcWall", "W", solid), product("IfcOpeningElement", "O", brep((1, -0.1, 1), (2, 0.3, 2)))
    rooted("IfcRelVoidsElement", RelatingBuildingElement=wall, RelatedOpeningElement=opening)
    product("IfcWindow", "V", pane)
    product("IfcSpace", "S", brep((0, 0.2, 0), (4, 4, 3)))
    source = new(
        "IfcRepresentationMap", origin, new("IfcShapeRepresentation", body, "Body", "Brep", [brep((0, 0, 0), (0.5, 0.3, 0.1))])
    )
    axes = [new("IfcDirection", tuple(map(float, axis))) for axis in ((-1, 0, 0), (0, 1, 0), (0, 0, 1))]
    mirror = new("IfcCartesianTransformationOperator3D", axes[0], axes[1], point(3000, 1000, 0), 1.0, axes[2])
    chair = product("IfcFurniture", "Chair", new("IfcMappedItem", source, mirror), "MappedRepresentation")
    rooted("IfcRelAssociatesMaterial", RelatedObjects=[chair], RelatingMaterial=new("IfcMaterial", "Oak"))
    file.write(str(path))


def test_a_model_that_ifcopenshell_writes(tmp_path):
    written(tmp_path / "m.ifc")
    with pytest.warns(rd.RadiosityWarning) as found:
        scene = rd.load_scene(tmp_path / "m.ifc")
    said = "\n".join(str(one.message) for one in found)
    assert scene.names == ("IfcWall/W/paint", "IfcWindow/V/pane", "IfcFurniture/Chair/Oak")
    rows = [scene.surface == i for i in range(3)]
    area = [scene.area[row].sum() for row in rows]
    assert area == pytest.approx([26.8 - 2 + 0.8, 2 + 4 * 0.02, 2 * (0.15 + 0.05 + 0.03)])
    assert scene.vertices[scene.faces[rows[2]].max(initial=0)].max() < 10  # metres
    outward = np.einsum("ij,ij->i", scene.normal, scene.frames[0] - (2.75, 1.15, 0.05))[rows[2]]
    assert (outward > 0).all()
    np.testing.assert_allclose(scene.transmittance[rows[1]] ** 2, 0.7)
    assert "shells that looked inward, of mirrored items, are turned: 'IfcFurniture/Chair'" in said
    assert "transparent surfaces are clear panes, which let all colours through alike: 'IfcWindow/V/pane (0.70)'" in said


def square(path, diffuse):
    """A square of 1 m whose points have numbers of their own, of colour 0.9, 0.5, 0.6 with a diffuse colour or factor."""
    ifc = pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed: pip install 'radiosity[ifc]'")
    file = ifc.file(schema="IFC4")
    new = file.create_entity
    origin = new("IfcAxis2Placement3D", new("IfcCartesianPoint", (0.0, 0.0, 0.0)))
    context = new("IfcGeometricRepresentationContext", "Body", "Model", 3, 1e-5, origin)
    units = new("IfcUnitAssignment", [new("IfcSIUnit", UnitType="LENGTHUNIT", Name="METRE")])
    new("IfcProject", GlobalId="0" * 22, RepresentationContexts=[context], UnitsInContext=units)
    points = new("IfcCartesianPointList3D", [(9.0, 9.0, 9.0), (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)])
    item = new("IfcTriangulatedFaceSet", points, None, False, [(1, 2, 3), (1, 3, 4)], [2, 3, 4, 5])
    kind, values = diffuse
    look = new("IfcSurfaceStyleRendering", new("IfcColourRgb", None, 0.9, 0.5, 0.6), ReflectanceMethod="NOTDEFINED")
    look.DiffuseColour = None if kind is None else new(kind, *values)
    new("IfcStyledItem", item, [new("IfcSurfaceStyle", "paint", "BOTH", [look])])
    shape = new("IfcProductDefinitionShape", None, None, [new("IfcShapeRepresentation", context, "Body", "Tessellation", [item])])
    new("IfcWall", GlobalId="1" * 22, Name="W", Representation=shape)
    file.write(str(path))


@pytest.mark.parametrize(
    ("diffuse", "color", "told"),
    [
        (("IfcNormalisedRatioMeasure", (0.0,)), (0.9, 0.5, 0.6), ["paint (0)"]),
        (("IfcColourRgb", (None, 0.2, 0.3, 0.4)), (0.2, 0.3, 0.4), []),
    ],
)
def test_colours_are_those_of_the_file_and_points_have_their_numbers(tmp_path, recwarn, diffuse, color, told):
    """IfcOpenShell #2509 and #5075: it multiplies the surface's colour by the diffuse one; a factor of 0 is black."""
    square(tmp_path / "m.ifc", diffuse)
    scene = rd.load_scene(tmp_path / "m.ifc")
    assert scene.area.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(scene.reflectance, [((np.array(color) + 0.055) / 1.055) ** 2.4])
    assert [name for one in recwarn for name in told if name in str(one.message)] == told


def test_a_factor_of_a_style_is_told():
    reader = Reader()
    style = {"name": "paint", "color": [0.9, 0.9, 0.9], "transparency": None, "side": "BOTH", "factor": 0.45}
    reader.add(Product("IfcWall", "W", (), (style,), box((0, 0, 0), (1, 1, 1)), BOX, np.zeros(12, int)))
    assert list(reader.factors) == ["paint (0.45)"]


def test_a_file_that_is_no_ifc_is_an_error(tmp_path):
    pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed: pip install 'radiosity[ifc]'")
    (tmp_path / "m.ifc").write_text("no STEP file")
    with pytest.raises(rd.SceneError, match=r"m\.ifc: ifcopenshell (cannot read it|finds no shapes)"):
        rd.load_scene(tmp_path / "m.ifc")


def test_without_ifcopenshell_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(run, "find_spec", lambda name: None)
    (tmp_path / "m.ifc").write_text("ISO-10303-21;")
    with pytest.raises(rd.SceneError, match=r"needs 'ifcopenshell'; pip install 'radiosity\[ifc\]'"):
        rd.load_scene(tmp_path / "m.ifc")


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "it was ended by signal 11; is the file damaged"),
        ("raise OSError('no header')", "ifcopenshell cannot read it: OSError: no header"),
        ("import time; time.sleep(60)", "did not finish in 1 s"),
    ],
)
def test_a_geometry_library_that_fails_is_an_error(tmp_path, monkeypatch, program, message):
    (tmp_path / "program.py").write_text(program)
    monkeypatch.setattr(run, "find_spec", lambda name: name)
    monkeypatch.setattr(run, "PROGRAM", tmp_path / "program.py")
    monkeypatch.setattr(run, "SECONDS", 1 if "sleep" in program else 60)
    (tmp_path / "m.ifc").write_text("ISO-10303-21;")
    with pytest.raises(rd.SceneError, match=message):
        rd.load_scene(tmp_path / "m.ifc")
