"""Experiment 4 (section 6, figure 7): the sample number generators."""

from ...method import Method
from ...method.model import AXES
from ..results import Results
from ..study import Arm, Claim

TITLE = "Sample number generators"
QUESTION = "The local discrete random walk with random numbers and six low discrepancy sequences."
SCENES = ("labyrinth-0.1", "labyrinth-0.5", "labyrinth-0.9", "room")
SEQUENCES = [name for name in AXES["numbers"] if name != "random"]
ARMS = tuple(Arm(name, Method(numbers=name, randomisation="shared"), name) for name in ("random", *SEQUENCES))


def claims(results: Results) -> list[Claim]:
    """Return the claims of section 6."""
    spreads, winners, halton = [], [], []
    for scene in SCENES:
        last = {name: results.last(scene, name) for name in SEQUENCES}
        best, worst = min(last, key=last.__getitem__), max(last, key=last.__getitem__)
        spreads.append((scene, last[worst] / last[best], best, worst))
        winners.append(best)
        halton.append((scene, last["halton"] / results.last(scene, "random")))
    return [
        Claim(
            "A speed difference of up to a factor 2 may be observed with different sequences.",
            all(spread < 2 for _, spread, *_ in spreads),
            "Largest over smallest error at the end: " + "; ".join(f"{s} {r:.2f} ({w} over {b})" for s, r, b, w in spreads) + ".",
        ),
        Claim(
            "No sequence is systematically superior.",
            len(set(winners)) > 1,
            "Least error: " + ", ".join(f"{scene} {winner}" for scene, winner in zip(SCENES, winners, strict=True)) + ".",
        ),
        Claim(
            "The simple Halton sequence behaves well in all cases.",
            all(r < 1 for _, r in halton),
            "Its error over that of random numbers: " + "; ".join(f"{scene} {r:.2f}" for scene, r in halton) + ".",
        ),
    ]
