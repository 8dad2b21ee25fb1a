"""``radiosity compare``"""

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from ..errors import OutputError, printable
from . import outputs
from .options import Count, Flag, Outputs, Share
from .streams import tell

DIFFERENT = 1


@dataclass(frozen=True)
class Sight:
    """The picture of the differences.

    Attributes:
        camera: Of a picture: number of the scene's camera, from 0. Default: the first, or one fitted to the scene.
        width: Of a picture, in pixels.
        height: Of a picture, in pixels.
        limit: Of a picture: the difference at which the colours end, above and below zero, in the unit of the quantity.
    """

    camera: int | None = None
    width: Count = None
    height: Count = None
    limit: float | None = None


USUAL = Sight()


def compare(
    first: Path,
    second: Path,
    /,
    *,
    quantity: Literal["irradiance", "radiosity"] = "irradiance",
    within: Share = None,
    of: Literal["patches", "surfaces"] = "patches",
    alpha: Share = None,
    reference: Flag = False,
    output: Outputs = (),
    sight: Annotated[Sight, Parameter(name="*")] = USUAL,
) -> int:
    """Compare two solutions: differences with their errors, by patch and by surface.

    The exit status is 0 where they agree, 1 where they differ and 2 where they cannot be compared. They agree where their errors
    explain the differences, or with --within where the differences are below it.

    Parameters
    ----------
    first
        An .npz file that `radiosity solve` wrote.
    second
        Another one of the same scene; its patches may be others. Relative differences are relative to it.
    quantity
        What is compared.
    within
        The largest relative difference that is allowed, such as 2%. Default: the errors decide.
    of
        What --within is of: the area-weighted RMS of patches, or the largest difference of the mean over a surface's side.
    alpha
        The probability with which solutions that agree are called different. Default: 5%.
    reference
        The second solution counts as exact: its errors are zero, whether it has any or not.
    output
        Files to write: .json (all figures), .csv (patches, and in NAME.surfaces.csv surfaces), .png (a picture of the
        differences, red where the first is larger), .svg or .pdf (a histogram).
    """
    from ..comparison import outputs as of_comparison

    of_comparison.check(output)

    import radiosity as rd

    a, b = (rd.load_solution(path) for path in (first, second))
    found = rd.compare(
        a,
        b,
        quantity=quantity,
        within=within,
        of=of,
        alpha=0.05 if alpha is None else alpha,
        reference=reference,
        names=(str(first), str(second)),
    )
    look = {"camera": sight.camera, "width": sight.width, "height": sight.height, "limit": sight.limit}

    def written(path: Path) -> None:
        found.save(path, **look)
        tell(f"wrote {printable(path)}")

    tell(found.report())
    failures = outputs.attempt((path, partial(written, path)) for path in output)
    if failures:
        raise OutputError("; ".join(outputs.told(failures)))
    if found.agrees is None:
        from ..errors import MethodError

        raise MethodError("no error of these solutions is known; give a tolerance (--within 2%), or --reference")
    return 0 if found.agrees else DIFFERENT
