"""Seconds to an error, measured against long references: ``make bench-error``.

Each scene is solved by each method with more and more lines, a few seeds each, and the true relative error is taken from a long
reference. So the seconds of CPU and wall that a method takes to 1 % and 0.3 % are known, and what a method's own error tells is
not asked. METHOD is a name with choices (``gather/reconstruction=smooth``), which may be of another commit
(``random-walk@59482bb``), or ``photon-loop`` (divided rooms). Methods that solve the continuous equation are compared with a
reference of that equation, where a scene has one.
"""

import argparse
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from error_formulas import rms
from error_processes import Process, Refused
from error_references import FOLDER, Reference, reference, same
from error_scenes import CONTROL_VARIATE, OLD, SETTINGS, Setting, missing
from error_tables import notes, tables
from history import keep

METHODS = (
    OLD,
    "gather",
    "gather/reconstruction=smooth",
    "auto",
    "random-walk",
    CONTROL_VARIATE,
    "particle-tracing",
    "photon-loop",
)
HISTORY = Path(__file__).with_name("history-error.jsonl")
WARM = 20_000  # lines that compile a method's kernels
QUICK = 0.05  # share of the lines of long references
STEP = 4  # from one number of lines to the next
ROW = "  {:<64} {:>13} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8}"


@dataclass
class Ladder:
    """The runs of a method: for each number of lines, least seconds and RMS errors over seeds."""

    truth: Reference
    lines: list[int] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)
    means: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)

    def add(self, runs: list[dict]) -> None:
        """Take in the runs of one number of lines."""
        self.lines.append(round(sum(run["rays"] for run in runs) / len(runs)))
        self.errors.append(rms([run["squares"] for run in runs], self.truth.variance))
        self.means.append(rms([run["means_squares"] for run in runs], self.truth.means_variance))
        self.cpu.append(min(run["cpu"] for run in runs))
        self.wall.append(min(run["wall"] for run in runs))

    def done(self, target: float, limit: float) -> bool:
        """Whether the next runs would take too long, or would show nothing about the target."""
        return self.errors[-1] < target or STEP * self.cpu[-1] > limit


def main() -> None:
    """Measure what was asked for, scene by scene."""
    chosen = arguments()
    for name in chosen.scenes:
        reason = missing(name)
        if reason:
            print(f"\n{name} is left out: {reason}", flush=True)
            continue
        try:
            measure(name, SETTINGS[name], chosen)
        except Refused as refused:
            print(f"{name} is left out: {refused}", flush=True)
    keep(HISTORY)
    print(f"\nthe figures are in {HISTORY}; `python benchmarks/history.py {HISTORY.name}` compares the last two runs")


def measure(name: str, setting: Setting, chosen: argparse.Namespace) -> None:
    """All methods on a scene, in turns, and its tables."""
    with Process(name, "random-walk") as process:
        size = process.ask("describe")
    print(f"\n{name}: {size['patches']:,} patches, {size['faces']:,} faces, {size['bands']} band(s)", flush=True)
    truths: dict[str, Reference] = {}
    with ExitStack() as stack:
        processes = {}
        for method in chosen.methods:
            try:
                process = stack.enter_context(Process(name, method))
                told = process.ask("describe")
                if not same(told, size):
                    raise Refused("it cuts the scene into other patches")
                equation = told["equation"]
                if equation not in truths:
                    truths[equation] = reference(name, setting, equation, size, chosen.references, QUICK if chosen.quick else 1.0)
                    truths[equation].tell(equation)
                process.ask("measure", rays=WARM, seed=0)
                processes[method] = process, truths[equation]
            except Refused as reason:
                print(f"  {method} is left out: {str(reason).partition(';')[0]}", flush=True)
        ladders = climb(processes, setting.first, chosen)
    if ladders:
        tables(ladders, chosen.targets)
        notes(name, ladders, chosen.targets)


def climb(processes: dict[str, tuple[Process, Reference]], rays: float, chosen: argparse.Namespace) -> dict[str, Ladder]:
    """Run more and more lines, the methods in turns, until each is done."""
    print(ROW.format("method", "lines", "CPU s", "wall s", "error", "surfaces", "stated", "of true"))
    ladders = {method: Ladder(truth) for method, (_, truth) in processes.items()}
    going = list(processes)
    while going:
        runs = {method: [] for method in going}
        for seed in range(1, chosen.seeds + 1):
            for method in list(runs):
                try:
                    process, truth = processes[method]
                    runs[method].append(process.ask("measure", rays=rays, seed=seed, reference=str(truth.file)))
                except Refused as reason:
                    print(f"  {method} ends before {rays:,.0f} lines: {reason}", flush=True)
                    del runs[method]
        for method, told in runs.items():
            ladder = ladders[method]
            ladder.add(told)
            row(method, ladder, sum(run["stated"] ** 2 for run in told) / len(told))
        going = [method for method in runs if not ladders[method].done(min(chosen.targets), chosen.limit)]
        rays *= STEP
    return {method: ladder for method, ladder in ladders.items() if ladder.lines}


def row(method: str, ladder: Ladder, stated: float) -> None:
    """Print the last runs of a ladder; ``stated`` is the mean square of the errors that they state."""
    error = ladder.errors[-1]
    ratio = f"{stated**0.5 / error:.2f}" if error else "-"
    seconds = (f"{ladder.cpu[-1]:.2f}", f"{ladder.wall[-1]:.2f}")
    errors = (f"{error:.3%}", f"{ladder.means[-1]:.3%}", f"{stated**0.5:.3%}", ratio)
    print(ROW.format(method, f"{ladder.lines[-1]:,}", *seconds, *errors), flush=True)


def arguments() -> argparse.Namespace:
    """What was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--scenes", nargs="+", choices=list(SETTINGS), default=list(SETTINGS), metavar="SCENE", help=", ".join(SETTINGS)
    )
    parser.add_argument(
        "--methods", nargs="+", default=list(METHODS), metavar="METHOD", help="those that do not exist are left out"
    )
    parser.add_argument("--targets", nargs="+", type=float, help="relative errors (0.01 0.003; quick: 0.05 0.02)")
    parser.add_argument("--seeds", type=int, help="runs of each number of lines (3; quick: 2)")
    parser.add_argument("--limit", type=float, help="seconds of CPU that a run may take (40; quick: 3)")
    parser.add_argument("--references", type=Path, default=FOLDER, help=f"the folder that keeps references ({FOLDER})")
    parser.add_argument("--quick", action="store_true", help="short runs and short references: minutes")
    chosen = parser.parse_args()
    chosen.targets = chosen.targets or ([0.05, 0.02] if chosen.quick else [0.01, 0.003])
    chosen.seeds = chosen.seeds or (2 if chosen.quick else 3)
    chosen.limit = chosen.limit or (3.0 if chosen.quick else 40.0)
    return chosen


if __name__ == "__main__":
    main()
