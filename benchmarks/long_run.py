"""Memory of a long run against the lines that it has traced: ``python benchmarks/long_run.py [--rays 1e10] [--scene room]``.

One row for each doubling of the lines: resident bytes then, and the most so far. Checkpoints are written as `radiosity solve`
writes them. The slope at the end is the change of resident bytes for each line, of a line fitted to the second half of all rows.
"""

import argparse
import resource
import tempfile
import time
from pathlib import Path

import numpy as np

import radiosity as rd

MIB = 2.0**20
ROW = "{:>16} {:>9} {:>14} {:>10} {:>10}"


def resident() -> float:
    """Return the mebibytes that the process has now."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / MIB


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rays", type=float, default=1e10)
    parser.add_argument("--scene", default="room")
    given = parser.parse_args()
    seen, next_row, begun = [], 2.0**23, time.perf_counter()

    def listen(progress) -> None:
        nonlocal next_row
        seen.append((progress.rays, resident()))
        if progress.rays >= next_row:
            next_row = 2 * progress.rays
            print(told(progress.rays, progress.error), flush=True)

    def told(rays: int, error: float) -> str:
        most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / MIB
        return ROW.format(rays, f"{time.perf_counter() - begun:.0f}", f"{error:.4%}", f"{resident():.1f}", f"{most:.1f}")

    print(ROW.format("lines", "wall s", "error", "MiB", "most MiB"))
    with tempfile.TemporaryDirectory() as folder:
        solution = rd.solve(
            rd.load_scene(given.scene),
            "random-walk",
            rays=given.rays,
            progress=listen,
            checkpoint=Path(folder) / "run.npz",
            checkpoint_every=30,
        )
    print(told(solution.rays, solution.error))
    rays, size = np.array(seen[len(seen) // 2 :]).T
    print(f"slope over the second half: {np.polyfit(rays, size, 1)[0] * MIB * 1e9:.0f} bytes in 10^9 lines, {len(rays)} moments")


if __name__ == "__main__":
    main()
