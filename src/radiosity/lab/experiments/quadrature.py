"""Experiment 8, an open end of the paper's section 4: which quadrature suits global lines."""

import numpy as np

from ...method import Method
from ..cases import MAZES
from ..results import Results
from ..study import Arm, Claim

AGAINST_TIME = True
TITLE = "Quadratures of global lines"
QUESTION = (
    "Low discrepancy numbers gain less for global lines than for local ones: four numbers of a sequence took the place of four "
    "random ones, and the paper calls a better quadrature an open topic. Which lines and which sequence gain most?"
)
SCENES = MAZES
KINDS = {
    "local": ("local", "breadth-first"),
    "two points": ("global", "multipath"),
    "disc": ("global-disc", "multipath"),
    "spans": ("spans", "multipath"),
}
SEQUENCES = {"Halton": "halton", "Sobol": "sobol"}
SLOW = "spans, Sobol"  # the arm whose error falls most slowly
ARMS = tuple(
    Arm(f"{kind}, {name}", Method(lines=lines, order=order, numbers=numbers, randomisation="shared"), kind)
    for kind, (lines, order) in KINDS.items()
    for name, numbers in SEQUENCES.items()
)


def claims(results: Results) -> list[Claim]:
    """Return what the full run found of quadratures, and whether this run finds it, too."""
    slopes = {arm.name: [results.slope(scene, arm.name) for scene in SCENES] for arm in ARMS}
    globally = [arm.name for arm in ARMS if arm.family != "local"]
    best = [min(globally, key=lambda name, scene=scene: results.last(scene, name)) for scene in SCENES]
    others = list(zip(*(slopes[name] for name in globally if name != SLOW), strict=True))
    timed = [_at_equal_time(results, scene, SLOW, "local, Halton") for scene in SCENES]
    return [
        Claim(
            "Not in the paper: of global lines, spans that are drawn one by one err least.",
            all(name.startswith("spans") for name in best),
            "Least error of global lines at the end: "
            + ", ".join(f"{s} {name} ({results.last(s, name):.2g})" for s, name in zip(SCENES, best, strict=True))
            + ".",
        ),
        Claim(
            "Not in the paper: the error falls at one rate by all quadratures of global lines (intervals of their slopes meet), "
            "but more slowly by spans with Sobol' points.",
            all(max(s.low for s in found) <= min(s.high for s in found) for found in others)
            and all(slow.value > max(s.value for s in found) for slow, found in zip(slopes[SLOW], others, strict=True)),
            "Slopes. "
            + "; ".join(
                f"{name}: " + ", ".join(f"{scene} {s}" for scene, s in zip(SCENES, found, strict=True))
                for name, found in slopes.items()
            )
            + ".",
        ),
        Claim(
            "Not in the paper: at equal time, spans with Sobol' points err more than local lines with Halton numbers (at most as "
            "much was asked for).",
            all(ratio > 1 for ratio in timed),
            "Error of spans with Sobol' numbers over that of local lines with Halton numbers, at the latter's last second: "
            + ", ".join(f"{scene} {ratio:.2f}" for scene, ratio in zip(SCENES, timed, strict=True))
            + ".",
        ),
    ]


def _at_equal_time(results: Results, scene: str, one: str, other: str) -> float:
    """Return the ratio of errors at the last time that both arms have, interpolated in logarithms."""
    series = [results.series[scene, name] for name in (one, other)]
    end = np.log(min(found.seconds[-1] for found in series))
    errors = [np.interp(end, np.log(found.seconds), np.log(np.sqrt((found.area_weighted**2).mean(axis=0)))) for found in series]
    return float(np.exp(errors[0] - errors[1]))
