"""CPU seconds of view factors to the error that other programs reach: ``make bench-heat``.

The scene is a closed box with a cylinder in it: between its 8 surfaces, and between 544 and 4 608 patches. The error is the RMS
of F_ij - truth_ij over all pairs, relative to the RMS of truth_ij; of 4 608 patches over every 96th row, which is also all that
raystrack traces there. The truth is two pairs of long runs, by counted lines and by exact polygons with visible shares, which
share no numbers; it is kept in a folder. For each size of a peer, the CPU seconds that `rd.view_factors` takes to the same error
are told. Programs take turns, each in a process of its own that is warm; seconds are the least over seeds.
"""

import argparse
import sys
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from error_formulas import rms, time_to
from error_processes import Process, Refused
from error_references import FOLDER as ERRORS
from heat_formulas import square, weighted
from history import keep, note

FOLDER = ERRORS.with_name("radiosity-bench-heat")
WORKER = Path(__file__).with_name("heat_worker.py")
HISTORY = Path(__file__).with_name("history-heat.jsonl")
SEED = {"lines": 101, "polygons": 202, "rows": 303}
ROW = "  {:<14} {:>18} {:>10} {:>9} {:>12} {:>12}"


@dataclass(frozen=True)
class Sizes:
    """What is run of a scene.

    Attributes:
        truth: lines (rays) of long runs by method; of "rows", rays of a pair and replicate.
        ours: numbers of lines.
        peers: sizes of each peer, see `heat_worker`.
    """

    truth: dict[str, int]
    ours: list[int]
    peers: dict[str, list]

    def quick(self) -> "Sizes":
        """The smallest size of each peer, and ours that take a second or two at most."""
        least = {peer: sizes[:1] for peer, sizes in self.peers.items()}
        return Sizes({how: rays // 5 for how, rays in self.truth.items()}, [n for n in self.ours if n <= SHORT], least)


SCENES = {
    "surfaces": Sizes(
        {"lines": 100_000_000, "polygons": 60_000_000},
        [1_000, 4_000, 16_000, 64_000, 256_000, 1_000_000, 4_000_000],
        {"raystrack": [[16, 16, 1], [16, 128, 1], [64, 128, 1], [64, 128, 4]], "pyviewfactor": [1, 2, 4, 6]},
    ),
    "544": Sizes(
        {"lines": 60_000_000, "polygons": 60_000_000},
        [64_000, 256_000, 1_000_000, 2_000_000, 5_000_000, 6_000_000, 8_000_000, 12_000_000, 24_000_000],
        {"raystrack": [[4, 128, 1], [16, 128, 1]], "pyviewfactor": [1, 2, 3]},
    ),
    "4608": Sizes(
        {"lines": 20_000_000, "rows": 128},
        [256_000, 1_000_000, 4_000_000, 16_000_000],
        {"raystrack": [[4, 128, 1]], "pyviewfactor": [1]},
    ),
}
QUICK, SHORT = ("surfaces", "544"), 8_000_000  # scenes and lines


@dataclass
class Ladder:
    """Least CPU seconds and RMS errors of the sizes of a program."""

    sizes: list = field(default_factory=list)
    errors: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)


def main() -> None:
    """Measure what was asked for, scene by scene."""
    chosen = arguments()
    for name in chosen.scenes or (QUICK if chosen.quick else SCENES):
        measure(name, SCENES[name].quick() if chosen.quick else SCENES[name], chosen)
    keep(HISTORY)
    print(f"\nthe figures are in {HISTORY}; `python benchmarks/history.py {HISTORY.name}` compares the last two runs")


def measure(name: str, sizes: Sizes, chosen: argparse.Namespace) -> None:
    """All programs on a scene, in turns, and the table."""
    file, variance = truth(name, sizes.truth, chosen.references)
    ladders = {}
    with ExitStack() as stack:
        going = {}
        for program, rungs in {"radiosity": sizes.ours, **sizes.peers}.items():
            try:
                python = sys.executable if program == "radiosity" else chosen.peers
                process = stack.enter_context(Process(name, program, WORKER, python))
                process.ask("warm", size=rungs[0])
                going[program], ladders[program] = process, Ladder()
            except Refused as reason:
                print(f"  {program} is left out: {reason}", flush=True)
        for rung in range(max(map(len, [sizes.ours, *sizes.peers.values()]))):
            runs = {program: [] for program in going if rung < len({"radiosity": sizes.ours, **sizes.peers}[program])}
            for seed in range(1, (1 if chosen.quick else chosen.seeds) + 1):
                for program in list(runs):
                    if program != "radiosity" and runs[program] and runs[program][0]["cpu"] > chosen.limit:
                        continue
                    size = {"radiosity": sizes.ours, **sizes.peers}[program][rung]
                    try:
                        runs[program].append(going[program].ask("measure", size=size, seed=seed, reference=str(file)))
                    except Refused as reason:
                        print(f"  {program} ends at size {size}: {reason}", flush=True)
                        del runs[program]
            for program, told in runs.items():
                ladder = ladders[program]
                ladder.sizes.append({"radiosity": sizes.ours, **sizes.peers}[program][rung])
                ladder.errors.append(rms([[run["square"]] for run in told], variance))
                ladder.cpu.append(min(run["cpu"] for run in told))
    table(name, ladders)


def table(name: str, ladders: dict[str, Ladder]) -> None:
    """Print every run, and what ours takes to the same error."""
    print(ROW.format("program", "size", "error", "CPU s", "ours, CPU s", "times less"), flush=True)
    ours = ladders["radiosity"]
    for program, ladder in ladders.items():
        for size, error, cpu in zip(ladder.sizes, ladder.errors, ladder.cpu, strict=True):
            row = [program, str(size), f"{error:.3%}", f"{cpu:.3g}"]
            if program != "radiosity":
                own = time_to(error, ours.errors, ours.cpu)
                mark = {"<": ">", "*": "*"}.get(own.mark, "")
                row += [str(own), f"{mark}{cpu / own.seconds:.1f}" if np.isfinite(own.seconds) else "-"]
                if np.isfinite(own.seconds):
                    note(f"{name}, {program} {size}: its CPU seconds over ours to its error", cpu / own.seconds, "times")
            print(ROW.format(*[*row, "", ""][:6]), flush=True)


def truth(name: str, long_runs: dict[str, int], folder: Path) -> tuple[Path, float]:
    """The reference of a scene, and the square of its own error; what is missing is made."""
    folder.mkdir(parents=True, exist_ok=True)
    found = {}
    for method, rays in long_runs.items():
        file = folder / f"{name}-{method}-{rays}.npz"
        if not file.exists():
            with Process(name, "rows" if method == "rows" else f"radiosity/{method}", WORKER) as process:
                process.ask("keep", size=rays, seed=SEED[method], file=str(file))
        with np.load(file) as opened:
            found[method] = opened["matrix"], float(opened["variance"])
    mean, variance = weighted(*map(list, zip(*found.values(), strict=True)))
    file = folder / f"{name}.npz"
    np.savez(file, matrix=mean)
    (one, its), (two, other) = found.values()
    apart = (square(one, two) / (its + other)) ** 0.5
    told = ", ".join(f"{method} {square**0.5:.4%}" for method, (_, square) in found.items())
    print(
        f"\n{name}: error of the reference {variance**0.5:.4%} ({told}; they are {apart:.2f} standard errors apart)", flush=True
    )
    if apart > 2:
        print("  the two do not agree: do not trust the errors below", flush=True)
    return file, variance


def arguments() -> argparse.Namespace:
    """What was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", choices=list(SCENES), help="parts of the run (default: all, or the quick ones)")
    parser.add_argument(
        "--quick", action="store_true", help=f"{' and '.join(QUICK)}, the smallest sizes, one seed: about a minute"
    )
    parser.add_argument("--seeds", type=int, default=3, help="runs of each size (3)")
    parser.add_argument("--limit", type=float, default=10.0, help="CPU seconds; longer runs of peers are not repeated (10)")
    parser.add_argument("--peers", default=sys.executable, metavar="PYTHON", help="the interpreter that has the peers")
    parser.add_argument("--references", type=Path, default=FOLDER, help=f"the folder that keeps references ({FOLDER})")
    return parser.parse_args()


if __name__ == "__main__":
    main()
