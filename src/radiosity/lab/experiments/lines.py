"""Experiment 2 (section 4, figure 5): local against global lines."""

from pathlib import Path

from ...method import PRESETS, Method
from .. import pictures, report
from ..results import Results
from ..study import Claim, Protocol, with_both_numbers

AGAINST_TIME = True
TITLE = "Local against global lines"
QUESTION = "Discrete particle tracing by local lines, by global lines, and by global lines after a first shot of local ones."
SCENES = ("labyrinth-0.1", "labyrinth-0.5", "labyrinth-0.9", "room")
KINDS = {
    "local": Method(),
    "global": PRESETS["global-multipath"].method,
    "global, first shot": PRESETS["global-multipath-first-shot"].method,
}
ARMS = with_both_numbers(KINDS)


def extras(protocol: Protocol, folder: Path) -> list[str]:
    """Return the paper's figure 1."""
    pictures.sample_lines(folder / "lines")
    return [
        report.figure(folder / "lines"),
        "<p>The paper's figure 1: local lines of one patch, and global lines with their spans (blue).</p>",
    ]


def claims(results: Results) -> list[Claim]:
    """Return the claims of section 4."""
    mazes = [scene for scene in SCENES if scene.startswith("labyrinth")]
    slopes = [(scene, results.slope(scene, "local, random"), results.slope(scene, "global, random")) for scene in mazes]
    same = all(a.low <= b.high and b.low <= a.high for _, a, b in slopes)
    worse, within = results.ratio("room", "global, random", "local, random")
    repaired, _ = results.ratio("room", "global, first shot, random", "local, random")
    halton = [(scene, *results.ratio(scene, "global, Halton", "local, Halton")) for scene in mazes]
    return [
        Claim(
            "With random numbers the choice of local or global lines does not affect the convergence rate (labyrinths).",
            same,
            "Slopes, local and global: " + "; ".join(f"{scene} {a} and {b}" for scene, a, b in slopes) + ".",
        ),
        Claim(
            "In the box with boxes global lines are clearly worse, since a span may or may not hit the small light.",
            worse / within > 1.5,
            f"Error of global over local lines in room, random: {worse:.1f} (within a factor {within:.2f}).",
        ),
        Claim(
            "A first pass by local lines remedies this.",
            repaired < worse / 1.5,
            f"After a first shot the ratio is {repaired:.1f}.",
        ),
        Claim(
            "With Halton numbers local lines have a significant advantage in the labyrinths as well.",
            None if not all(r / w > 1 for _, r, w in halton) else True,
            "Error of global over local lines, Halton: "
            + "; ".join(f"{scene} {r:.2f} (within {w:.2f})" for scene, r, w in halton)
            + ".",
        ),
    ]
