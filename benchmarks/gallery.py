"""Takes the pictures of docs/gallery.md, each beside a path traced one, and prints their times: ``make gallery``.

python benchmarks/gallery.py [--width 240] [--folder docs/figures/gallery] [--scenes cornell-box studio]
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from pictures import traced, used

import radiosity as rd
from radiosity.image import curves, render, tone

SAMPLES = 128  # a pixel, of the path tracer
LINES = 256  # a pixel, of the final gather
RAYS = 2_000_000  # of the solution
SCENES = ("cornell-box", "room", "studio")
GAP = 6  # pixels between both pictures


def pair(name: str, width: int, folder: Path) -> str:
    """Write the picture of a scene, and return its row of the table."""
    scene = rd.load_scene(name)
    view = scene.cameras[0]
    render(rd.solve(scene, rays=10_000), width=16, final_gather=16)  # kernels are compiled
    begun = used()
    solution = rd.solve(scene, rays=RAYS)
    solved = used()
    path = folder / "gathered.exr"
    camera = replace(view, width=width, height=round(width * view.height / view.width))
    ours = render(solution, path, camera=camera, final_gather=LINES, denoise=True).astype(float)
    seconds = used() - solved
    path.unlink()
    theirs, of_paths = traced(scene, camera, SAMPLES, 1)
    scale = tone.automatic_scale(theirs.reshape(-1, scene.n_bands))
    both = [curves.displayed(one, scale, "agx") for one in (ours, theirs)]
    gap = np.full((camera.height, GAP, 3), 255, np.uint8)
    from PIL import Image

    whole = Image.fromarray(np.concatenate([both[0], gap, both[1]], axis=1))
    whole.save(folder / f"{name}.jpg", quality=88, optimize=True)
    return f"| `{name}` | {solved - begun:.1f} | {seconds:.1f} | {of_paths:.1f} |"


def main() -> None:
    """Take all of them, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--width", type=int, default=240)
    parser.add_argument("--folder", type=Path, default=Path(__file__).parents[1] / "docs" / "figures" / "gallery")
    parser.add_argument("--scenes", nargs="+", default=SCENES)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    print("| scene | solution: CPU s | final gather: CPU s | path tracer: CPU s |\n|---|---|---|---|", flush=True)
    for name in given.scenes:
        print(pair(name, given.width, given.folder), flush=True)


if __name__ == "__main__":
    main()
