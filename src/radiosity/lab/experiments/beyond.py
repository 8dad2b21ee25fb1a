"""Experiment 5, not in the paper: results do not depend on the order, to the bit; and error bars are true."""

from pathlib import Path

from ...method import PRESETS, Method
from .. import cases, report
from ..bits import bits
from ..calibration import LEVELS, LINES, REPLICATES, SEEDS, coverage
from ..study import Arm, Protocol

TITLE = "Bits and error bars"
QUESTION = (
    "Does the result depend on the order of lines, on threads, on stages? And how often does the true value lie inside the "
    "stated intervals?"
)
ARMS = (
    Arm("random walk, Halton", Method(), "discrete"),
    Arm("random walk, Sobol", Method(numbers="sobol"), "discrete"),
    Arm("random walk, random", Method(numbers="random"), "discrete"),
    Arm("particle tracing, Halton", PRESETS["particle-tracing"].method, "continuous"),
    Arm("stochastic Jacobi, Halton", PRESETS["stochastic-jacobi"].method, "iteration"),
    Arm("global multipath, Halton", PRESETS["global-multipath"].method, "global"),
)


def extras(protocol: Protocol, folder: Path) -> list[str]:
    """Return two tables."""
    case = cases.maze("labyrinth-0.5")
    rows = bits(case, protocol.seed)
    same = len({row.digest for row in rows[:-1]}) == 1 and rows[-1].digest != rows[0].digest
    found = [coverage(arm, case, cases.ones(case), protocol.seed) for arm in ARMS]
    shares = [[f"{100 * share:.1f} ± {100 * error:.1f} %" for share, error in row.covered] for row in found]
    return [
        "<h3>The same integers however they are counted</h3>",
        report.table(["run", "hash of all counters"], [[row.how, row.digest] for row in rows]),
        f"<p><b class='{'yes' if same else 'no'}'>"
        f"{'All runs of one seed end in the same bits.' if same else 'Hashes differ: a fault.'}</b></p>",
        f"<h3>Are the error bars true?</h3><p>{case.name}, {SEEDS} runs of {REPLICATES} replicates of {LINES} lines; the share "
        "of patches and runs whose Student interval holds the true value, with its standard error over runs.</p>",
        report.table(
            ["arm", *(f"{100 * level:g} % interval" for level in LEVELS), "RMS error"],
            [[row.arm, *share, f"{row.rms:.2%}"] for row, share in zip(found, shares, strict=True)],
        ),
    ]
