"""``python -m validation [--quick] [-o FOLDER]``: run all referees, write the page, say who disagrees."""

import argparse
import sys
import time
import warnings
from pathlib import Path

import radiosity as rd

from . import enclosures, light, page, path_tracer, rtrace, view_factors
from .comparison import ALPHA, Patchwise, Value

TEXTS = {
    "Closed rooms": "Exact exchange between grey surfaces: resistances in series, exact matrices of rooms whose walls "
    "are one patch each, and rooms where irradiance is the same everywhere. Spheres are of facets, and two meshes of them "
    "are extrapolated.",
    "View factors": "One surface emits, all are black: the share of its power that lands on another. Numbers with a C are those "
    "of J. R. Howell's catalogue of configuration factors; the others follow from it by closure, reciprocity, crossed strings "
    "or as ratios of areas. `tests/test_exact_integrals.py` and `tests/test_catalogue.py` hold each formula "
    "against numerical integration. Round bodies are "
    "of facets with the body's area, of two sizes, and extrapolated; bodies that are 'long' are 400 widths long, and what "
    "leaves through their ends is allowed for.",
    "A furnace, patch by patch": "Emission is one less reflectance, so that radiosity and irradiance are one everywhere.",
    "Mitsuba's path tracer": "Irradiance of every patch: paths from uniform points on it, of unlimited depth, with light sampled "
    "directly and by chance. The scene is blown up to a kilometre first: Mitsuba's paths go on 0.1 mm or more away from "
    "surfaces, which at its own size makes the Cornell box's short block 0.1 % too bright. A path tracer solves the "
    "continuous equation, so particle tracing is compared as it is. "
    "The default random walk solves that of the patches: for it the RMS change of each surface where patches are cut into "
    "four, times two, is added to the error ('allowed'), which makes chi-square smaller than one. "
    "Patches that another face nearly touches (the back of the Cornell box's lamp, a millimetre below the ceiling) "
    "are left out of that comparison: there only patches of a millimetre would do.",
    "Radiance's rtrace": "Irradiance (`rtrace -I`) at random points of every patch, by single paths without cache, "
    "interpolation or cut (see `validation/rtrace.py` for the options). Lamps are black, as Radiance's are. In the "
    "furnace, whose faces both emit and reflect, they are mixtures of plastic and glow. Its random numbers differ from run to "
    "run, so the figures of this table do too.",
    "Light at points, by Radiance's rtrace": "Irradiance at sensors that look up, on a grid of 1 m at 0.85 m, in rooms of "
    "5 x 4 x 3 m that reflect half of the light, with patches of 0.25 m. The options of `rtrace` are those of the table above. "
    "Lamps are spheres of a centimetre there, and the sky is a glow of 1 + 2 sin h. For the sensor that differs most two "
    "standard errors are allowed. Errors are those of both sides, and mostly rtrace's.",
}


def main(arguments: list[str]) -> int:
    """Number of comparisons that disagree."""
    parser = argparse.ArgumentParser(prog="validation", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer lines: about a minute")
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/validation"), help="folder of index.md")
    chosen = parser.parse_args(arguments)
    warnings.simplefilter("ignore", rd.RadiosityWarning)
    started = time.monotonic()
    closed = list(told(enclosures.run(chosen.quick)))
    sections = [
        ("Closed rooms", [row for row in closed if isinstance(row, Value)]),
        ("View factors", list(told(view_factors.run(chosen.quick)))),
        ("A furnace, patch by patch", [row for row in closed if isinstance(row, Patchwise)]),
        ("Mitsuba's path tracer", list(told(path_tracer.run(chosen.quick)))),
        ("Radiance's rtrace", list(told(rtrace.run(chosen.quick)))),
        ("Light at points, by Radiance's rtrace", list(told(light.run(chosen.quick)))),
    ]
    rows = [row for _, found in sections for row in found]
    off = sum(not agrees(row) for row in rows)
    tables = [
        (page.values if isinstance(found[0], Value) else page.patches)(name, TEXTS[name], found) for name, found in sections
    ]
    kind = "a quick run" if chosen.quick else "a full run"
    summary = f"This is {kind}: {len(rows)} comparisons, of which {off or 'none'} disagree{'s' if off < 2 else ''}.\n"
    chosen.output.mkdir(parents=True, exist_ok=True)
    (chosen.output / "index.md").write_text("\n".join([page.INTRODUCTION, summary, *tables]))
    print(f"{summary.strip()} {chosen.output / 'index.md'} written after {time.monotonic() - started:.0f} s")
    return off


def agrees(row: Value | Patchwise) -> bool:
    return row.p > ALPHA if isinstance(row, Value) else row.agrees


def told(rows):
    """Each row is printed as it comes."""
    for row in rows:
        print(f"{'' if agrees(row) else 'DISAGREES '}{row.name}: p {row.p:.3f}", flush=True)
        yield row


if __name__ == "__main__":
    sys.exit(min(main(sys.argv[1:]), 1))
