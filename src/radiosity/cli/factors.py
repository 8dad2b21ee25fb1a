"""``radiosity factors``"""

from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Group, Parameter

from ..errors import MethodError, OutputError, printable
from . import interrupts, outputs
from .options import Count, DeviceName, Flag, Length, Outputs, Seed, Share
from .solve import NOT_REACHED
from .solve_options import SceneOptions, Unset
from .streams import tell

Texts = Annotated[tuple[str, ...], Parameter(consume_multiple=(1, None), negative=(), show_default=False)]
SHOWN = 12  # groups: a larger matrix is not printed


@dataclass(frozen=True)
class Tracing:
    """Lines and patches.

    Attributes:
        rays: Number of lines in all, such as 1M (the default), or the work of as many for polygons; beside --error the limit.
        error: Take more lines until the RMS error of all factors, over their RMS, is below this, such as 1%; in 95 % of runs the
            true error then is. A run that ends above it has the exit status 3.
        error_of: row:NAME makes --error the error of the factors of one row.
        method: lines counts lines; polygons takes exact factors and the visible share of each pair; auto takes what has the
            smaller predicted error after as much work.
        patch_size: Longest edge of a patch, in metres. Default: faces are not cut; with --group patch, about 20 000 patches.
        cells: Cut every face into CELLS x CELLS patches.
        sources: Names of small surfaces that get more lines.
        replicates: Number of independent randomised runs, from which errors are found.
        seed: Seed of all random numbers. Equal seeds give equal results.
        device: auto, cpu or cuda.
        memory: Memory limit, such as 8G or none. Default: 70 % of what is free.
        cluster: Trace lines on the workers of Dask, as of `radiosity solve`: tcp://HOST:PORT, or local:N.
    """

    rays: Count = None
    error: Share = None
    error_of: str | None = None
    method: Literal["auto", "lines", "polygons"] = "auto"
    patch_size: Length = None
    cells: Count = None
    sources: Texts = ()
    replicates: Count = 8
    seed: Seed = 0
    device: DeviceName = "auto"
    memory: str | None = None
    cluster: str | None = None


TracingOptions = Annotated[Tracing, Parameter(name="*", group=Group("Lines and patches", sort_key=1))]
USUAL = Tracing()


def factors(
    scene: str,
    /,
    *,
    output: Outputs = (),
    group: Literal["surface", "patch"] = "surface",
    merge: Texts = (),
    raw: Flag = False,
    layout: Literal["matrix", "long"] = "matrix",
    zone: str | None = None,
    tracing: TracingOptions = USUAL,
    reading: SceneOptions = Unset.reading,
) -> int:
    """Find view factors between surfaces or patches, with standard errors.

    F in row i and column j is the share of what leaves i that arrives at j. What escapes from the scene and what is lost on backs
    that do not radiate are columns: with them each row sums to one. Areas are those of radiating sides.

    Parameters
    ----------
    scene
        A scene file (.xml .glb .gltf .obj .ply .stl .mgf .rad .hbjson .ifc .vs3 .toml), a built-in scene, or an .npz file of
        `radiosity lines`, whose lines are taken.
    output
        Files to write: .csv, .npz, and .idf (ZoneProperty:UserViewFactors:BySurfaceName of EnergyPlus).
    group
        Factors between surfaces (each radiating side is one) or between patches.
    merge
        Groups of surfaces that count as one, such as "walls=north,south" "lamps=lamp*".
    raw
        Write factors as they were counted, without restoring reciprocity.
    layout
        Of a .csv: a matrix, or a long table with a row for each pair.
    zone
        Name of the zone in an .idf file.
    """
    from ..exchange import factor_outputs

    factor_outputs.check(output, zone)

    import radiosity as rd

    from .progress import bar

    if merge and group != "surface":
        raise MethodError("--merge puts surfaces together, and --group patch takes them apart; leave one of the two out")
    if tracing.patch_size is not None and tracing.cells is not None:
        raise MethodError("give one of --patch-size and --cells, not both")
    options: dict[str, Any] = asdict(tracing) | {"sources": tracing.sources or None}
    cells = {"size": options.pop("patch_size"), "cells": options.pop("cells")}
    if Path(scene).suffix.lower() == ".npz":
        usual = asdict(USUAL)
        changed = [f"--{name.replace('_', '-')}" for name, value in asdict(tracing).items() if value != usual[name]]
        if changed:
            raise MethodError(f"{scene} holds lines that are there already: leave {', '.join(changed)} out, or give the scene")
        outputs.spare([scene], output)
        cut, options = rd.load_lines(scene), {}
    else:
        cut = outputs.scene_of(scene, reading, output)
        cut = rd.subdivide(cut, **cells) if any(value is not None for value in cells.values()) else cut
    chosen: str | dict = merged_groups(merge) if merge else group
    with bar() as progress:
        found = rd.view_factors(cut, group=chosen, progress=progress, **options)
    result = found if raw or not found.reciprocal else found.restored()
    tasks: list = [("the report", lambda: _print(result))]
    failures = outputs.attempt([*tasks, *((path, partial(_write, result, path, zone, layout)) for path in output)])
    if failures:
        raise OutputError("; ".join(outputs.told(failures)))
    if found.status == "interrupted":
        return interrupts.status()
    return NOT_REACHED if found.status == "not reached" else 0


def merged_groups(texts: tuple[str, ...]) -> dict[str, list[str]]:
    """Return groups by name, from NAME=SURFACE,SURFACE."""
    groups: dict[str, list[str]] = {}
    for text in texts:
        name, equals, members = text.partition("=")
        if not equals or not name or not members:
            raise MethodError(f"--merge is '{text}'; write NAME=SURFACE,SURFACE, such as walls=north,south")
        if name in groups:
            raise MethodError(f"--merge gives '{name}' twice; name all its surfaces at once")
        groups[name] = members.split(",")
    return groups


def _write(result, path: Path, zone: str | None, layout: str) -> None:
    from ..exchange import factor_outputs

    factor_outputs.write(result, path, zone, layout)
    tell(f"wrote {printable(path)}")


def _print(result) -> None:
    tell(repr(result))
    shares = [*result.matrix.T, result.escaped, result.lost]
    errors = [*result.standard_error.T, result.escaped_standard_error, result.lost_standard_error]
    tell_matrix(result.names, zip(*shares, strict=True), zip(*errors, strict=True))


def tell_matrix(names: tuple[str, ...], shares, errors) -> None:
    """Print shares of groups with standard errors, a row each; the last columns are escaped and lost. Many groups are left out.

    Args:
        shares, errors: n rows of n + 2 numbers each.
    """
    if len(names) > SHOWN:
        return
    width = max(12, *(len(printable(name)) for name in names))
    tell(" " * width + "".join(f"  {printable(title)[:14]:>14}" for title in [*names, "escaped", "lost"]))
    for name, row, errors_of_row in zip(names, shares, errors, strict=True):
        cells = (f"{share:.5f} ±{error:.0e}" if share or error else "0" for share, error in zip(row, errors_of_row, strict=True))
        tell(f"{printable(name):<{width}}" + "".join(f"  {cell:>14}" for cell in cells))
