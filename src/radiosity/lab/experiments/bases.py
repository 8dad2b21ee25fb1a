"""Experiment 7, an open end of the paper's section 6: light that is a polynomial on each patch."""

from pathlib import Path

from .. import report, slopes
from ..study import Claim, Protocol
from ..varying import Curve, Truth, curve
from ..varying_figure import draw

TITLE = "Linear and quadratic light on patches"
QUESTION = (
    "The paper's light is constant on each patch. How many patches and lines do gathers need where it is a polynomial? Constants "
    "have cells of half the width, so four times the patches."
)
ROOMS = ("room", "cornell-box")
CELLS, QUICK_CELLS = (2, 4, 8), (2, 4)  # of polynomials; of constants twice as many along each edge
FINER = 4  # cells of the truth along each edge of the smallest ones of polynomials
LINES, QUICK_LINES = 100e6, 10e6  # of the truth
LAST = 20  # the ladder ends at 2^20 lines of a replicate, or earlier
ARMS = {"constant": 2, "linear": 1, "quadratic": 1}  # cells along an edge, times those of polynomials


def extras(protocol: Protocol, folder: Path) -> list[str]:
    """Return a figure, the claims, and a table."""
    quick = protocol.last < Protocol().last
    cells, lines = (QUICK_CELLS, QUICK_LINES) if quick else (CELLS, LINES)
    rungs = [rung for rung in protocol.rungs if rung <= 1 << LAST]
    found: dict[str, list[Curve]] = {}
    parts = []
    for scene in ROOMS:
        truth = Truth.of(scene, FINER * cells[-1], lines, protocol.seed + 1)
        parts.append(f"<p>Relative error of the reference of {scene} in {len(truth.patches)} patches: {truth.own:.2g}.</p>")
        arms = ((count * times, basis) for basis, times in ARMS.items() for count in cells)
        curves = [curve(truth, count, basis, rungs, protocol.replicates, protocol.seed) for count, basis in arms]
        found[scene] = [one for one in curves if len(one.lines)]
    path = folder / "experiment-7"
    draw(found, TITLE, path)
    heads = ["scene", "basis", "patches", "lines", "error", "within"]
    rows = [[scene, *_cells(one, at)] for scene, curves in found.items() for one in curves for at in range(len(one.lines))]
    return [report.figure(path), *parts, report.verdicts(claims(found)), report.table(heads, rows)]


def claims(found: dict[str, list[Curve]]) -> list[Claim]:
    """Return what is expected of polynomials: ratios of errors with the most lines."""
    return [
        _less(found, "linear", "constant", "at equal lines, linear light errs less than constants on four times the patches."),
        _less(found, "quadratic", "linear", "on equal patches and at equal lines, quadratic light errs less than linear light."),
    ]


def _less(found: dict[str, list[Curve]], one: str, other: str, says: str) -> Claim:
    """Return a claim about the finest meshes of two bases."""
    pairs = {scene: [[c for c in curves if c.basis == basis][-1] for basis in (one, other)] for scene, curves in found.items()}
    ratios = {scene: slopes.ratio(first.errors, second.errors) for scene, (first, second) in pairs.items()}
    told = (
        f"{scene} {ratio:.2f} (within a factor {within:.2f}), {pairs[scene][0].patches} and {pairs[scene][1].patches} patches"
        for scene, (ratio, within) in ratios.items()
    )
    agrees = all(ratio * within < 1 for ratio, within in ratios.values())
    return Claim(f"Not in the paper: {says}", agrees, f"Error of {one} over {other} light at the end: {'; '.join(told)}.")


def _cells(one: Curve, at: int) -> list[str]:
    errors = one.errors[:, at]
    error, spread = slopes.mean_error(one.errors)[at], errors.std(ddof=1) / len(errors) ** 0.5
    return [one.basis, str(one.patches), f"{one.lines[at]:.3g}", f"{error:.2%}", f"{spread:.2%}"]
