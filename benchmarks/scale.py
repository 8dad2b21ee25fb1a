"""Time and memory of runs against the numbers of faces and patches, from 10^2 to 10^7: ``python benchmarks/scale.py``.

Each row is a process of its own: a closed box in three colours, 8 replicates, four lines a patch in each. In one series all
patches are faces; in the other at most 10^4 faces are cut. Rows are appended to `scale.jsonl`, or to another file. Those of
`docs/figures/scale.jsonl` are what `scale_figure.py` draws. A run is left out where the machine has not the memory that it is
expected to take.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

ROWS = Path(__file__).with_name("scale.jsonl")
SIZES = (100, 1_000, 10_000, 100_000, 1_000_000, 3_000_000, 10_000_000)
SERIES = {"faces": 0, "patches": 10_000}  # most faces; 0: every patch is one
SHARE = 0.9  # of what is free, for a row
LINES = 4  # a patch and replicate
ROW = "{:<8} {:>10} {:>10} {:>8} {:>8} {:>8} {:>9} {:>9} {:>9} {:>6}"


def child(kind: str, size: int, replicates: int) -> None:
    """Run one row, and print its figures as JSON."""
    import resource
    import time

    from scale_scene import box

    import radiosity as rd
    from radiosity.device import memory
    from radiosity.problem.model import Problem
    from radiosity.run.memory_estimate import memory_needed

    def peak() -> float:
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024.0

    rd.solve(rd.subdivide(box(100), cells=1), "random-walk", rays=1e5, replicates=replicates)  # compiles kernels
    times, begun = {}, time.process_time()

    def took(what: str) -> None:
        nonlocal begun
        now = time.process_time()
        times[what], begun = now - begun, now

    most = SERIES[kind]
    cells = 1 if not most else max(1, round((size / most) ** 0.5))
    scene = box(round(size / cells**2))
    took("scene")
    patches = rd.subdivide(scene, cells=cells)
    _ = patches.reflectance, patches.emission, patches.area
    took("patches")
    made, rays = peak(), float(LINES * len(patches) * replicates)
    method = rd.Method()
    wanted = memory_needed(method, patches, Problem.of(patches).groups.n_groups, replicates, rays)
    row = {"series": kind, "faces": scene.n_faces, "patches": len(patches), "replicates": replicates}
    row |= {"scene_bytes": made, "expected": wanted, "free": memory.free()}
    if wanted < SHARE * memory.free():
        now = resident()
        with memory.limited("none"):
            solution = rd.solve(patches, method, rays=rays, replicates=replicates)
        took("run")
        row |= {"peak": peak(), "before": now, "taken": peak() - now, "rays": solution.rays, "wall": solution.seconds}
        row |= {"error": solution.error}
    print(json.dumps(row | {"seconds": times}))


def resident() -> float:
    """Return the bytes that the process has now."""
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmRSS"))
    return 1024.0 * int(line.split()[1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--series", nargs="+", choices=SERIES, default=list(SERIES))
    parser.add_argument("--sizes", nargs="+", type=float, default=list(SIZES))
    parser.add_argument("--replicates", type=int, default=8)
    parser.add_argument("-o", "--output", type=Path, default=ROWS)
    parser.add_argument("--child", action="store_true", help="one row in this process; prints JSON")
    given = parser.parse_args()
    if given.child:
        return child(given.series[0], int(given.sizes[0]), given.replicates)
    print(ROW.format("series", "faces", "patches", "scene s", "patch s", "run s", "peak", "taken", "expected", "ratio"))
    for kind in given.series:
        for size in given.sizes:
            command = [sys.executable, "-W", "ignore", __file__, "--child", "--series", kind, "--sizes", str(size)]
            done = subprocess.run([*command, "--replicates", str(given.replicates)], capture_output=True, text=True)
            if done.returncode:
                print(kind, f"{size:g}", "ended:", done.stderr.strip()[-300:], flush=True)
                continue
            row = json.loads(done.stdout.splitlines()[-1])
            with given.output.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
            print(told(row), flush=True)


def told(row: dict) -> str:
    """Return a row of the table."""
    seconds, gib = row["seconds"], 2**30
    sizes = [f"{row[name] / gib:.2f}" if name in row else "-" for name in ("peak", "taken", "expected")]
    ratio = f"{row['expected'] / row['taken']:.2f}" if "taken" in row else "-"
    spent = [f"{seconds[name]:.2f}" if name in seconds else "-" for name in ("scene", "patches", "run")]
    return ROW.format(row["series"], row["faces"], row["patches"], *spent, *sizes, ratio)


if __name__ == "__main__":
    main()
