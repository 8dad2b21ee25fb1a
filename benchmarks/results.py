"""Memory and time that results take while they are written, for each format: ``python benchmarks/results.py``.

The closed box of `scale_scene.py`, at most 10^4 faces of which are cut, in three colours with two replicates. Each format is
written by a process of its own, a copy of the one that has solved, so that no format finds the memory of another.
"""

import argparse
import os
import tempfile
import time
from pathlib import Path

from scale_scene import box

import radiosity as rd
from radiosity.lab.footprint import peak, resident

FACES = 10_000
ROW = "{:<6} {:>8} {:>10} {:>12} {:>12} {:>8}"


def written(solution, path: Path, options: dict) -> None:
    """Write one file, and print its row."""
    before, begun = resident(), time.process_time()
    solution.save(path) if path.suffix == ".npz" else solution.export(path, **options)
    seconds, most, size = time.process_time() - begun, peak() - before, path.stat().st_size
    n = len(solution.patches)
    kind = "smooth" if options.get("smooth", True) else "flat"
    print(ROW.format(path.suffix, kind, n, f"{most / n:.0f}", f"{size / n:.0f}", f"{seconds:.1f}"), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--patches", type=float, default=1e6)
    given = parser.parse_args()
    cells = max(1, round((given.patches / FACES) ** 0.5))
    patches = rd.subdivide(box(round(given.patches / cells**2)), cells=cells)
    solution = rd.solve(patches, "random-walk", rays=len(patches), replicates=2)
    print(ROW.format("format", "", "patches", "bytes, most", "bytes, file", "CPU s"), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for number, suffix in enumerate((".npz", ".glb", ".ply", ".vtp", ".glb", ".ply", ".vtp")):
            child = os.fork()
            if not child:
                written(solution, Path(folder, f"out{suffix}"), {"smooth": number < 4})
                os._exit(0)
            os.waitpid(child, 0)


if __name__ == "__main__":
    main()
