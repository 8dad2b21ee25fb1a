"""Experiment 9, an open end of the paper's section 5: array-RQMC, continuous walks whose particles are sorted between hits."""

from ...method import Method
from ..cases import MAZES
from ..results import Results
from ..study import Arm, Claim

AGAINST_TIME = True
TITLE = "Continuous walks with sorted particles"
QUESTION = (
    "The continuous walk takes many numbers, and low discrepancy numbers gain it little. Do they gain more where particles are "
    "sorted by place between hits (array-RQMC, L'Ecuyer, Lécot and Tuffin 2008)?"
)
SCENES = MAZES
BOUND = -0.6
KINDS = {"plain": "breadth-first", "sorted": "sorted"}
ARMS = tuple(
    Arm(f"{kind}, {name}", Method(equation="continuous", order=order, numbers=numbers, randomisation="shared"), kind)
    for kind, order in KINDS.items()
    for name, numbers in (("random", "random"), ("Halton", "halton"), ("Sobol", "sobol"))
)


def claims(results: Results) -> list[Claim]:
    """Return what is expected of array-RQMC."""
    slopes = {arm.name: [results.slope(scene, arm.name) for scene in SCENES] for arm in ARMS}
    ratios = [results.ratio(scene, "sorted, Halton", "plain, Halton") for scene in SCENES]
    return [
        Claim(
            "Not in the paper: sorted particles converge faster than N^-0.6, plain ones do not.",
            all(s.value < BOUND for s in (*slopes["sorted, Halton"], *slopes["sorted, Sobol"]))
            and all(s.value > BOUND for s in slopes["plain, Halton"]),
            _told(slopes, ("plain, Halton", "sorted, Halton", "sorted, Sobol")),
        ),
        Claim(
            "Not in the paper: with random numbers for the directions sorting changes no rate.",
            all(s.low <= -0.5 <= s.high for s in slopes["sorted, random"]),
            _told(slopes, ("plain, random", "sorted, random")),
        ),
        Claim(
            "Not in the paper: at equal lines sorted particles err less.",
            all(ratio * within < 1 for ratio, within in ratios),
            "Error of sorted over plain walks at the end, Halton: "
            + ", ".join(f"{scene} {r:.2f} (within {w:.2f})" for scene, (r, w) in zip(SCENES, ratios, strict=True))
            + ".",
        ),
    ]


def _told(slopes: dict, names: tuple[str, ...]) -> str:
    return (
        "Slopes. "
        + "; ".join(
            f"{name}: " + ", ".join(f"{scene} {slope}" for scene, slope in zip(SCENES, slopes[name], strict=True))
            for name in names
        )
        + "."
    )
