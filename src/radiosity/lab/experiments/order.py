"""Experiment 1 (section 3, figure 4): the order of sampling."""

from dataclasses import replace
from pathlib import Path

from ...method import PRESETS
from .. import cases, figures, pictures, report
from ..results import Results
from ..start import starts
from ..study import Claim, Protocol, with_both_numbers

TITLE = "Sampling order"
QUESTION = (
    "Local discrete methods that differ in the order of their lines alone: stochastic ray, random walk, WDRS, Shirley, "
    "Feda-Purgathofer."
)
SCENES = ("labyrinth-0.1", "labyrinth-0.5", "labyrinth-0.9", "room")
ORDERS = {
    "stochastic ray": PRESETS["stochastic-ray"].method,
    "random walk": replace(PRESETS["random-walk"].method, order="depth-first"),
    "WDRS": PRESETS["wdrs"].method,
    "Shirley": PRESETS["shirley"].method,
    "Feda-Purgathofer": PRESETS["progressive-ray-refinement"].method,
}
ARMS = with_both_numbers(ORDERS)


def extras(protocol: Protocol, folder: Path) -> list[str]:
    """Return the start of a run, as a figure."""
    case = cases.maze("labyrinth-0.5")
    path = folder / "experiment-1-start"
    figures.starts({case.name: starts(case, cases.ones(case), protocol.seed)}, "The start of a run, by order", path)
    pictures.orders(folder / "orders")
    return [
        report.figure(folder / "orders"),
        "<p>The paper's figure 2: the same lines, numbered in the order in which they are fired, breadth-first above and "
        "depth-first below.</p>",
        report.figure(path),
        "<p>At the start orders differ. Depth-first has a complete, if noisy, solution after one walk, and so has each stage. "
        "Breadth-first lacks light reflected k times until its k-th wavefront; "
        "the crosses are its wavefronts in a run of 2<sup>13</sup> "
        "lines. Where it ends all are equal.</p>",
    ]


def claims(results: Results) -> list[Claim]:
    """Return the claims of section 3."""
    found, alike = [], True
    for scene in SCENES:
        for kind in ("random", "Halton"):
            slopes = {name: results.slope(scene, f"{name}, {kind}") for name in ORDERS}
            walk = slopes["random walk"]
            alike &= all(s.low <= walk.high and s.high >= walk.low for s in slopes.values())
            found.append(f"{scene}, {kind}: " + ", ".join(f"{name} {slope}" for name, slope in slopes.items()))
    behind = [(s, results.ratio(s, "stochastic ray, Halton", "random walk, Halton")[0]) for s in SCENES]
    found.append(
        "error of stochastic ray over random walk's at the end, Halton: "
        + ", ".join(f"{s} {r:.1f}" for s, r in behind)
        + " (where it "
        "is steeper it still makes up for its start-up, see docs/iterations.md)"
    )
    same = ("Shirley", "WDRS", "Feda-Purgathofer")
    equal = all(results.equal(scene, "random walk, Halton", f"{name}, Halton") for scene in SCENES for name in same)
    return [
        Claim(
            "The sampling order has no influence on the long term convergence rate.", alike, "Slopes. " + "; ".join(found) + "."
        ),
        Claim(
            "The reason given: approximately the same sample lines are generated in each algorithm.",
            equal,
            "Random walk, Shirley, WDRS and Feda-Purgathofer are orders of one machine here, and end in "
            f"{'equal errors to the last bit' if equal else 'DIFFERENT errors, which is a fault of ours,'} at equal quanta. "
            "Stochastic ray draws its numbers of lines anew in each iteration.",
        ),
    ]
