#!/usr/bin/env bash
# ifcopenshell 0.8.4 leaves out PnIndex of a tessellated face set: corners are taken as numbers of points, where IFC4 has them as
# numbers of entries of PnIndex, which name the points. Programs write PnIndex where several face sets share one list of points.
# The square of 1 m2 below becomes 6 m2, and nothing is said. 0.9.0.post1 follows it.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
cat > "$folder/square.py" <<'PYTHON'
import sys

import ifcopenshell
import ifcopenshell.geom
import numpy as np

file = ifcopenshell.file(schema="IFC4")
new = file.create_entity
origin = new("IfcAxis2Placement3D", new("IfcCartesianPoint", (0.0, 0.0, 0.0)))
context = new("IfcGeometricRepresentationContext", None, "Model", 3, 1e-5, origin)
body = new("IfcGeometricRepresentationSubContext", ContextIdentifier="Body", ContextType="Model", ParentContext=context,
           TargetView="MODEL_VIEW")
units = new("IfcUnitAssignment", [new("IfcSIUnit", UnitType="LENGTHUNIT", Name="METRE")])
new("IfcProject", GlobalId=f"{0:022d}", RepresentationContexts=[context], UnitsInContext=units)
others, square = ((0, 0), (3, 0), (3, 2), (0, 2)), ((5, 5), (6, 5), (6, 6), (5, 6))  # points of another face set, and of this one
points = new("IfcCartesianPointList3D", [(float(x), float(y), 0.0) for x, y in others + square])
item = new("IfcTriangulatedFaceSet", Coordinates=points, CoordIndex=[(1, 2, 3), (1, 3, 4)], PnIndex=(5, 6, 7, 8))
shape = new("IfcShapeRepresentation", body, "Body", "Tessellation", [item])
new("IfcFurniture", GlobalId=f"{1:022d}", Name="square", ObjectPlacement=new("IfcLocalPlacement", None, origin),
    Representation=new("IfcProductDefinitionShape", Representations=[shape]))
iterator = ifcopenshell.geom.iterator(ifcopenshell.geom.settings(), file, 1)
assert iterator.initialize()
geometry = iterator.get().geometry
corner = np.array(geometry.verts).reshape(-1, 3)[np.array(geometry.faces).reshape(-1, 3)]
area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum() / 2
print(f"ifcopenshell {ifcopenshell.version}: {area:.3f} m2")
assert abs(area - float(sys.argv[1])) < 1e-6, "the behaviour has changed"
PYTHON
while read -r version area; do
    python3 -m venv "$folder/$version"
    "$folder/$version/bin/pip" install --quiet --disable-pip-version-check "ifcopenshell==$version" 'numpy==2.3.5'
    "$folder/$version/bin/python" "$folder/square.py" "$area"
done <<'VERSIONS'
0.8.4 6
0.9.0.post1 1
VERSIONS
echo 'as stated: 6 m2 in place of 1'
