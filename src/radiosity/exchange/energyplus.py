"""EnergyPlus: the view factors of a zone as an object ``ZoneProperty:UserViewFactors:BySurfaceName``.

Names of groups must be the names of the zone's surfaces. EnergyPlus takes a zone as closed: it scales rows of any sum to one
without a word. So factors of which something escapes or is lost are refused here: that part would be given to the other surfaces.
"""

import warnings
from pathlib import Path

import numpy as np

from ..errors import OutputError, RadiosityWarning, shown
from ..solution.csv_rows import open_text
from ..solution.replacing import replacing

OBJECT = "ZoneProperty:UserViewFactors:BySurfaceName"
OPEN = 0.01  # share of a row that may be missing
TOLD = 1e-6  # share above which it is told
FORBIDDEN = ",;!\n\r"  # fields end with a comma or a semicolon; an exclamation mark begins a comment
LONGEST = 100  # characters of a name


def write(factors, path, zone: str) -> None:
    """Write the object.

    Args:
        factors: of groups named as the surfaces of the zone; those that are `restored` are reciprocal.
        path: an .idf file, to append to a model or to include.
        zone: the name of the zone (or space).

    Raises:
        OutputError: something escapes or is lost, a name does not fit IDF, or the file cannot be written.
    """
    _check(factors, path, zone)
    matrix, missed = factors.matrix, factors.escaped + factors.lost
    if missed.max() > TOLD:
        worst = int(missed.argmax())
        warnings.warn(
            f"{path}: up to {missed.max():.2g} of what a surface sends ('{factors.names[worst]}') escapes or is lost; EnergyPlus "
            "scales rows to one, which gives it to the other surfaces",
            RadiosityWarning,
            stacklevel=3,
        )
    with replacing(Path(path)) as temporary, open_text(temporary) as file:
        file.write(f"! View factors by radiosity, {factors.method}, {factors.restoration or 'not restored'}.\n")
        file.write(f"{OBJECT},\n  {zone},  !- Zone or ZoneList or Space or SpaceList Name\n")
        n = len(factors)
        for number, (i, j) in enumerate(np.ndindex(n, n), 1):
            end = ";" if number == n * n else ","
            file.write(f"  {factors.names[i]},  !- From Surface {number}\n  {factors.names[j]},  !- To Surface {number}\n")
            file.write(f"  {matrix[i, j]:.9f}{end}  !- View Factor {number}\n")


def _check(factors, path, zone: str) -> None:
    missed = factors.escaped + factors.lost
    if (missed > OPEN).any():
        rows = np.flatnonzero(missed > OPEN)
        told = shown([f"{factors.names[i]}: {missed[i]:.1%}" for i in rows[np.argsort(-missed[rows])]])
        raise OutputError(
            f"{path}: EnergyPlus takes a zone as closed and scales rows to one, but a part of what these surfaces send escapes "
            f"or is lost: {told}; close the scene, or group only the inside of the zone"
        )
    for name in (zone, *factors.names):
        if not name.strip() or len(name) > LONGEST or any(character in FORBIDDEN for character in name):
            raise OutputError(
                f"{path}: '{name}' is no name in IDF: at most {LONGEST} characters, without a comma, a semicolon or '!'; rename "
                "the surface, or give groups with other names"
            )
    folded = [name.strip().casefold() for name in factors.names]
    twice = sorted({name for name in folded if folded.count(name) > 1})
    if twice:
        raise OutputError(f"{path}: EnergyPlus takes capital and small letters as equal, and there are two of {shown(twice)}")
