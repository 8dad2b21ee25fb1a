#!/usr/bin/env bash
# ifcopenshell 0.9.0.post1 gives the triangles of a mirrored item inside out. IFC mirrors by a mapped item whose
# IfcCartesianTransformationOperator3D has axes of the other handedness (Axis1 = -x), as programs write for doors and furniture.
# The box below has a signed volume of +0.015 m3 where it stands as it is, and of -0.015 m3 where it is mirrored; the setting
# `reorient-shells` changes nothing. Whoever takes the front from the order of corners (one-sided surfaces, volumes, thermal
# programs) gets it wrong, and nothing is said.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'ifcopenshell==0.9.0.post1' 'numpy==2.3.5'
"$folder/venv/bin/python" - <<'PYTHON'
import ifcopenshell
import ifcopenshell.geom
import numpy as np

file = ifcopenshell.file(schema="IFC4")
new = file.create_entity


def point(*values):
    return new("IfcCartesianPoint", tuple(map(float, values)))


origin = new("IfcAxis2Placement3D", point(0, 0, 0))
context = new("IfcGeometricRepresentationContext", None, "Model", 3, 1e-5, origin)
body = new("IfcGeometricRepresentationSubContext", ContextIdentifier="Body", ContextType="Model", ParentContext=context,
           TargetView="MODEL_VIEW")
units = new("IfcUnitAssignment", [new("IfcSIUnit", UnitType="LENGTHUNIT", Name="METRE")])
new("IfcProject", GlobalId=f"{0:022d}", RepresentationContexts=[context], UnitsInContext=units)
corners = [point(x, y, z) for z in (0, 0.1) for x, y in ((0, 0), (0.5, 0), (0.5, 0.3), (0, 0.3))]
rings = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))  # all fronts outside
faces = [new("IfcFace", [new("IfcFaceOuterBound", new("IfcPolyLoop", [corners[i] for i in ring]), True)]) for ring in rings]
brep = new("IfcFacetedBrep", new("IfcClosedShell", faces))
source = new("IfcRepresentationMap", origin, new("IfcShapeRepresentation", body, "Body", "Brep", [brep]))
for number, (name, x) in enumerate((("as it is", 1), ("mirrored", -1)), 1):
    axes = [new("IfcDirection", tuple(map(float, axis))) for axis in ((x, 0, 0), (0, 1, 0), (0, 0, 1))]
    move = new("IfcCartesianTransformationOperator3D", axes[0], axes[1], point(2 * number, 0, 0), 1.0, axes[2])
    shape = new("IfcShapeRepresentation", body, "Body", "MappedRepresentation", [new("IfcMappedItem", source, move)])
    new("IfcFurniture", GlobalId=f"{number:022d}", Name=name, ObjectPlacement=new("IfcLocalPlacement", None, origin),
        Representation=new("IfcProductDefinitionShape", Representations=[shape]))

for reorient in (False, True):
    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    settings.set("reorient-shells", reorient)
    iterator = ifcopenshell.geom.iterator(settings, file, 1)
    assert iterator.initialize()
    volumes = {}
    while True:
        shape = iterator.get()
        corner = np.array(shape.geometry.verts).reshape(-1, 3)[np.array(shape.geometry.faces).reshape(-1, 3)]
        volumes[shape.name] = np.einsum("ij,ij->i", corner[:, 0], np.cross(corner[:, 1], corner[:, 2])).sum() / 6
        if not iterator.next():
            break
    print(f"reorient-shells {reorient}:", {name: f"{volume:+.4f} m3" for name, volume in volumes.items()})
    assert abs(volumes["as it is"] - 0.015) < 1e-9, volumes
    assert abs(volumes["mirrored"] + 0.015) < 1e-9, "the behaviour has changed"
PYTHON
echo 'as stated: the mirrored box is inside out'
