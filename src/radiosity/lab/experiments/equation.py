"""Experiment 3 (section 5, figure 6): discrete, continuous, and Keller's quasi-Monte Carlo radiosity."""

from dataclasses import replace
from pathlib import Path

from ...method import PRESETS, Method
from .. import report
from ..discretisation import discretisation
from ..results import Results
from ..study import Arm, Claim, Protocol, with_both_numbers

TITLE = "Discrete against continuous walks"
QUESTION = (
    "Local walks of the discrete and of the continuous equation, and Keller's quasi-Monte Carlo radiosity, whose later segments "
    "take the same bases in other orders, or, by his own rule, the next prime bases. Curves show the "
    "computational error alone: each against the solution of its own equation."
)
SCENES = ("labyrinth-0.1", "labyrinth-0.5", "labyrinth-0.9", "room")
KINDS = {
    "discrete": Method(),
    "continuous": PRESETS["particle-tracing"].method,
    "Keller": PRESETS["qmc-radiosity"].method,
}
OWN = "Keller, prime bases"
ARMS = (
    *with_both_numbers(KINDS),
    Arm(OWN, replace(KINDS["Keller"], padding="prime-bases", randomisation="shared"), OWN),
)


def extras(protocol: Protocol, folder: Path) -> list[str]:
    """Return the discretisation error apart from the computational one, on meshes of the room."""
    lines = 20e6 if protocol.last >= 20 else 4e6
    rows = [discretisation(count, lines, protocol.seed) for count in (2, 4, 8)]
    heads = ["patches", "discrete", "continuous", "delta of equation 6"]
    cells = [[f"{row.patches}", f"{row.discrete:.2%}", f"{row.continuous:.2%}", f"{row.delta:.2%}"] for row in rows]
    smaller = all(row.continuous < row.discrete for row in rows)
    return [
        "<h3>Discretisation error in the room</h3><p>RMS of B(x) - B<sub>i</sub> over that of the reflected light, B(x) from a "
        f"mesh four times finer, {lines:.2g} lines each.</p>",
        report.table(heads, cells),
        "<p>The paper: discretisation error will be lower with continuous walks, in which it is not propagated. "
        f"<b class='{'yes' if smaller else 'no'}'>This run: {'agrees' if smaller else 'differs'}</b>, by little: most of it is "
        "that of piecewise constant values, which both have.</p>",
    ]


def claims(results: Results) -> list[Claim]:
    """Return the claims of section 5."""
    random = [(scene, name, results.slope(scene, f"{name}, random")) for scene in SCENES for name in ("discrete", "continuous")]
    halton = [(scene, results.slope(scene, "discrete, Halton"), results.slope(scene, "continuous, Halton")) for scene in SCENES]
    gaps = [results.ratio(scene, "continuous, Halton", "discrete, Halton")[0] for scene in SCENES[:3]]
    keller = [(scene, results.ratio(scene, "Keller, Halton", "continuous, Halton")[0]) for scene in SCENES]
    own = [(scene, *results.ratio(scene, OWN, "Keller, Halton")) for scene in SCENES]
    return [
        Claim(
            "With random numbers both converge as N^-1/2.",
            all(slope.low <= -0.5 <= slope.high for *_, slope in random),
            "Slopes: " + "; ".join(f"{scene} {name} {slope}" for scene, name, slope in random) + ".",
        ),
        Claim(
            "With Halton numbers the discrete walk converges significantly faster, up to N^-0.7 against N^-0.6.",
            all(d.value < c.value for _, d, c in halton[:3]),
            "Slopes, discrete and continuous: " + "; ".join(f"{scene} {d} and {c}" for scene, d, c in halton) + ".",
        ),
        Claim(
            "The difference appears to be larger for higher average reflectivity.",
            None,
            "Error of continuous over discrete at the end: "
            + ", ".join(f"{s} {g:.1f}" for s, g in zip(SCENES, gaps, strict=False))
            + ".",
        ),
        Claim(
            "Keller's algorithm is inferior to both.",
            all(r > 1 for _, r in keller),
            "Its error over the continuous walk's, Halton: " + "; ".join(f"{scene} {r:.2f}" for scene, r in keller) + ".",
        ),
        Claim(
            "Not in the paper: how much the rule of later segments changes.",
            None,
            "Error with prime bases over that with the same bases in other orders: "
            + "; ".join(f"{scene} {r:.2f} (within {w:.2f})" for scene, r, w in own)
            + ".",
        ),
    ]
