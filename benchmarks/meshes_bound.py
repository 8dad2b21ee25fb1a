"""How far meshes could go: bounds of the discretisation error from light that is gathered at points of every face.

- "any mesh" is a lower bound for all meshes of so many patches that respect faces. Constants on pieces of a face miss least where
  the values of its points are sorted and cut into runs, wherever the points lie. Each side and band is sorted by itself. A piece
  of a two-sided face is two patches, since both sides are cut alike. Pieces go to the faces where they gain most.
- "halves" is the best mesh of the cuts that `radiosity.adapt` makes, with the light known: parallelograms are halved along
  either edge again and again, and triangles are cut into a parallelogram and two triangles. After "solved" is the error of a
  solution on that mesh, as `meshes.py` measures it: of all points, and of those outside luminaires.

With --contacts faces are cut along contact lines before they are halved. Errors are of reflected light, by area, relative to its
RMS, less noise.

python benchmarks/meshes_bound.py [--scenes cornell-box room FILE.mgf] [--patches 5000] [--times 2] [--points 30000] [--contacts]
"""

import argparse
import heapq
import warnings
from dataclasses import replace

import numpy as np
from meshes import EACH, READ, Places, errors, even_mesh, luminaires, solved
from meshes_halves import Tree, halved
from meshes_light import Light, gathered

import radiosity as rd
from radiosity.patches.cells_as_faces import turned
from radiosity.patches.contact import cut_at_contacts


class Runs:
    """The least that constants on k pieces of a face miss, for k = 1, 2, ..., by dynamic programming over sorted values."""

    def __init__(self, light: Light, weight: float) -> None:
        self.scale = weight * light.area / light.u.size
        values = np.sort(light.values.reshape(len(light.values), -1), axis=1)
        values -= values.mean(axis=1, keepdims=True)
        zero = np.zeros((len(values), 1))
        self.one = np.concatenate([zero, values.cumsum(axis=1)], axis=1)
        self.two = np.concatenate([zero, (values**2).cumsum(axis=1)], axis=1)
        self.least = self._costs(slice(0, 1))[:, 0]  # of values up to each
        self.cost = self.scale * self.least[:, -1].sum()

    def _costs(self, begin: slice) -> np.ndarray:
        n = self.one.shape[1]
        first, last = np.arange(n)[begin, None], np.arange(n)[None, :]
        one = self.one[:, None, :] - self.one[:, begin, None]
        two = self.two[:, None, :] - self.two[:, begin, None]
        return np.where(last > first, two - one**2 / np.maximum(last - first, 1), 0.0)

    def more(self) -> float:
        """Return what one more piece gains."""
        n, step = self.one.shape[1], 128
        least = self.least.copy()
        for begin in range(0, n, step):
            rows = slice(begin, min(begin + step, n))
            costs = self.least[:, rows, None] + self._costs(rows)
            costs = np.where(np.arange(n)[None, :] >= np.arange(n)[rows, None], costs, np.inf)
            least = np.minimum(least, costs.min(axis=1))
        gain = self.cost - self.scale * least[:, -1].sum()
        self.least, self.cost = least, self.cost - gain
        return max(gain, 0.0)


def any_mesh(lights: list[Light], weights: np.ndarray, counts: list[int]) -> list[float]:
    """Return the lower bound of the squared error of any mesh of so many patches, for each number (they rise)."""
    runs = [Runs(light, weight) for light, weight in zip(lights, weights, strict=True)]
    total = sum(run.cost for run in runs)
    used = sum(light.sides for light in lights)
    heap = [(-run.more() / light.sides, i) for i, (run, light) in enumerate(zip(runs, lights, strict=True))]
    heapq.heapify(heap)
    found = []
    for count in counts:
        while used < count:
            rate, i = heapq.heappop(heap)
            if rate == 0:
                break
            total, used = total + rate * lights[i].sides, used + lights[i].sides
            heapq.heappush(heap, (-runs[i].more() / lights[i].sides, i))
        found.append(total)
    return found


def compare(name: str, counts: list[int], times: list[float], points: int, contacts: bool) -> None:
    """Print what meshes of a scene miss: of all points, and of those that are not on bright surfaces."""
    scene = rd.load_scene(name, allow_outside=True)
    scene = replace(scene, back=np.where(scene.back == rd.Back.PASSES, rd.Back.ABSORBS, scene.back).astype(np.uint8))
    least = len(rd.subdivide(scene, cells=1))
    wanted = sorted([*(max(count, least) for count in counts), *(int(time * least) for time in times)])
    evens = [even_mesh(scene, count) for count in wanted]
    numbers = [len(even) for even in evens]
    read = solved(rd.adapt(scene, least + READ, seed=7))
    bright = luminaires(read)
    places = Places.of(read, 6000, np.random.default_rng(1))
    truth = rd.measure(read, rd.Sensors.of(places.points, places.normals), rays=EACH * len(places.points), seed=2)

    def told(patches: rd.Patches) -> str:
        found = errors(solved(patches), places, truth, bright)
        return "   ".join(f"{one:.2%} ({low:.2%}-{high:.2%})" for one, low, high in found)

    base = turned(cut_at_contacts(scene, numbers[-1], numbers[-1] // 8, near=0.1) if contacts else scene)
    lights = gathered(base, read, points, 3)
    calm = (~bright[base.surface]).astype(float)
    area = np.array([light.area for light in lights])
    noise = area * [light.noise.mean(axis=(1, 2)).sum() for light in lights]
    power = area * [(light.values**2).mean(axis=(1, 2)).sum() for light in lights] - noise
    known, error = sum(light.u.size * light.sides for light in lights), np.sqrt(noise.sum() / power.sum())
    here = len(rd.subdivide(base, cells=1))
    print(f"{name}: {least} sides, here {here}; light at {known} points, noise {error:.2%}", flush=True)
    for number, even in zip(numbers, evens, strict=True):
        print(f"  {number} patches. even: {told(even)}", flush=True)
        print(f"  follows the light: {told(rd.adapt(scene, number))}", flush=True)
    for what, weights in (("all", np.ones(len(lights))), ("elsewhere", calm)):
        there, quiet = weights @ power, weights @ noise
        trees = [Tree(light, weight) for light, weight in zip(lights, weights, strict=True)]
        for number in numbers:
            patches, missed = halved(base, trees, number)
            expected = np.sqrt(max(missed, 0) / there)
            print(f"  halves for {what}, {len(patches)}: {expected:.2%}, solved {told(patches)}", flush=True)
        if not contacts:
            for number, missed in zip(numbers, any_mesh(lights, weights, numbers), strict=True):
                print(f"  any mesh, {what}, {number}: {np.sqrt(max(missed - quiet, 0) / there):.2%}", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="+", default=["cornell-box", "room"])
    parser.add_argument("--patches", nargs="*", type=int, default=[])
    parser.add_argument("--times", nargs="*", type=float, default=[2.0], help="times the number of sides of the scene")
    parser.add_argument("--points", type=int, default=30_000)
    parser.add_argument("--contacts", action="store_true")
    given = parser.parse_args()
    warnings.simplefilter("ignore")
    for scene_name in given.scenes:
        compare(scene_name, given.patches, given.times, given.points, given.contacts)
