"""How quickly files of many triangles are read: ``python benchmarks/reading.py [--triangles 1e6 1e7]``.

Files are written to a temporary folder. Each row is a process of its own, which reads its file once, then several times more: the
seconds are those of the quickest of these. `bare` says how often as long as trimesh takes for the same file without any checks
(`process=False`).
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import trimesh

ROW = "{:<7} {:<4} {:>10} {:>8} {:>8} {:>12} {:>7}"
HEAD = ("shape", "file", "triangles", "wall s", "CPU s", "million a s", "bare")
FILES = {"sphere": ("ply", "glb"), "scan": ("ply", "glb"), "box": ("ply",), "soup": ("ply", "stl")}
NOISE = 0.1  # of the distance between two vertices of a meridian


def sphere(triangles: int) -> trimesh.Trimesh:
    """Return a sphere of meridians and parallels: slivers at its poles, and no parallelograms but near its equator."""
    rings = max(round((triangles / 4) ** 0.5), 3)
    return trimesh.creation.uv_sphere(count=[rings + 1, rings + 2])


def scan(triangles: int) -> trimesh.Trimesh:
    """Return a sphere whose vertices are off by chance, as those of scanned things."""
    mesh = sphere(triangles)
    step, random = np.pi / (triangles / 4) ** 0.5, np.random.Generator(np.random.Philox(1))
    return trimesh.Trimesh(mesh.vertices + NOISE * step * random.normal(size=mesh.vertices.shape), mesh.faces, process=False)


def box(triangles: int) -> trimesh.Trimesh:
    """Return a closed box, all of whose triangles are halves of rectangles."""
    from scale_scene import box as of_rectangles

    scene = of_rectangles(triangles // 2)
    halves = scene.faces[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return trimesh.Trimesh(scene.vertices, halves, process=False)


def soup(triangles: int) -> trimesh.Trimesh:
    """Return a sphere whose triangles have vertices of their own."""
    mesh = sphere(triangles)
    corners = mesh.vertices[mesh.faces].reshape(-1, 3)
    return trimesh.Trimesh(corners, np.arange(len(corners)).reshape(-1, 3), process=False)


SHAPES = {"sphere": sphere, "scan": scan, "box": box, "soup": soup}


def child(path: Path, runs: int) -> None:
    """Read a file so often, and print figures as JSON."""
    import time
    import warnings

    import radiosity as rd

    warnings.simplefilter("ignore", rd.RadiosityWarning)  # that there are no materials

    def quickest(read) -> tuple[float, float]:
        found = []
        for _ in range(runs):
            wall, cpu = time.perf_counter(), time.process_time()
            read()
            found.append((time.perf_counter() - wall, time.process_time() - cpu))
        return min(found)

    rd.load_scene(path)
    wall, cpu = quickest(lambda: rd.load_scene(path))
    bare = quickest(lambda: trimesh.load_mesh(path, process=False))[0]
    print(json.dumps({"wall": wall, "cpu": cpu, "bare": bare}))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--triangles", nargs="+", type=float, default=[1e6])
    parser.add_argument("--shapes", nargs="+", choices=SHAPES, default=list(SHAPES))
    parser.add_argument("--runs", type=int, default=5, help="readings in a process")
    parser.add_argument("--child", type=Path, help="read this file in this process; prints JSON")
    given = parser.parse_args()
    if given.child:
        return child(given.child, given.runs)
    print(ROW.format(*HEAD))
    with tempfile.TemporaryDirectory(prefix="reading-") as folder:
        for triangles in given.triangles:
            for shape in given.shapes:
                mesh = SHAPES[shape](int(triangles))
                for ending in FILES[shape]:
                    path = Path(folder) / f"{shape}.{ending}"
                    mesh.export(path)
                    command = [sys.executable, __file__, "--child", str(path), "--runs", str(given.runs)]
                    row = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
                    path.unlink()
                    count = len(mesh.faces)
                    speed, bare = f"{count / row['wall'] / 1e6:.2f}", f"{row['wall'] / row['bare']:.1f}"
                    told = (shape, ending, count, f"{row['wall']:.3f}", f"{row['cpu']:.3f}", speed, bare)
                    print(ROW.format(*told), flush=True)


if __name__ == "__main__":
    main()
