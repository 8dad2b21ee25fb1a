"""``radiosity relight``"""

from functools import reduce
from operator import add
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..errors import MethodError
from . import outputs
from .solve_options import OutputOptions, Unset
from .streams import tell

KEYS, SIDES = ("emission", "reflectance"), ("front", "back")
FORM = "write NAME.emission=VALUE or NAME.reflectance=VALUE, such as lamp.emission=100, walls.reflectance=0.8,0.5,0.3"


def relight(
    lines: Path,
    /,
    *more: Path,
    changes: Annotated[
        tuple[str, ...], Parameter(name="--set", consume_multiple=(1, None), negative=(), show_default=False)
    ] = (),
    bands: Annotated[tuple[str, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)] = (),
    files: OutputOptions = Unset.output,
) -> int:
    """Solve with lines that `radiosity lines` has counted, for other light and other colours. No line is traced.

    Several files are added: other replicates, or other seeds, of the same geometry.

    Parameters
    ----------
    lines
        An .npz file of lines. More of them may follow.
    changes
        Emission or reflectance of a surface in place of the scene's, several at once: NAME.emission=VALUE or
        NAME.reflectance=VALUE. VALUE is a number, or one for each band with commas between; emission is in W/m² or lm/m². NAME
        may be a pattern such as lamp*, and later ones replace earlier ones. NAME.emission.front and NAME.emission.back are one
        side alone; without a side emission is that of the sides that emit in the scene, or else of all that radiate.
    bands
        Names of the bands, such as --bands 450nm 550nm 650nm.
    """
    values = _values(changes)
    outputs.check(files.output)
    import radiosity as rd

    outputs.spare([lines, *more], outputs.files_of(files.output))
    found = reduce(add, [rd.load_lines(path) for path in (lines, *more)])
    outputs.spare([found.patches.scene.source], outputs.files_of(files.output))
    solution = found.solve(**values, bands=bands or None)
    outputs.write(solution, files.output, exposure=files.exposure, also=[("the report", lambda: tell(solution.report()))])
    return 0


def _values(changes: tuple[str, ...]) -> dict[str, dict | None]:
    """Return what `LineSet.solve` takes: for emission and reflectance a dictionary from names to values, or None.

    Raises:
        MethodError: a change is written in another way.
    """
    found: dict[str, dict] = {key: {} for key in KEYS}
    for text in changes:
        place, _, written = text.rpartition("=")
        name, _, key = place.rpartition(".")
        side = ""
        if key in SIDES:
            side, (name, _, key) = key, name.rpartition(".")
        if key not in KEYS or not name:
            raise MethodError(f"--set {text!r} is not understood; {FORM}")
        try:
            value = [float(part) for part in written.split(",")]
        except ValueError:
            raise MethodError(f"--set {text!r}: '{written}' is no number, nor numbers with commas between; {FORM}") from None
        earlier = found[key].pop(name, None)  # the last one counts, and comes last
        if side:
            found[key][name] = (earlier if isinstance(earlier, dict) else {}) | {side: value}
        else:
            found[key][name] = value
    return {key: changed or None for key, changed in found.items()}
