"""A process of ``make bench-heat``: view factors of one scene by one program, as often as it is told to.

``python heat_worker.py SCENE PROGRAM`` reads a JSON object a line from standard input and answers each with one. Only the program
that is asked for is imported. Scenes are made before the clock starts. What each program builds of them (trees, pairs, tables) is
in the time, and so are restoration and the dense matrix.
"""

import json
import os
import sys
import warnings
from pathlib import Path

import numpy as np
from heat_formulas import grouped, square
from heat_scene import CUTS, NAMES, STEPS, SURFACES, Mesh, mesh, parents

BETWEEN_SURFACES = "surfaces"


def used() -> float:
    """CPU seconds of this process so far, of all its threads."""
    times = os.times()
    return times.user + times.system


class Ours:
    """`radiosity.view_factors`, restored; "auto" chooses lines or polygons. A size is a number of lines."""

    def __init__(self, scene: str, method: str):
        import radiosity

        self.package, self.method = radiosity, method or "auto"
        faces = mesh(SURFACES if scene == BETWEEN_SURFACES else CUTS[scene])
        numbers = np.arange(4 * len(faces.area)).reshape(-1, 4)
        numbers[faces.triangle, 3] = -1
        made = radiosity.Scene.from_arrays(
            faces.corners.reshape(-1, 3), numbers, 0.5, 0.0, surface=faces.surface, names=NAMES, source="bench-heat"
        )
        self.patches = radiosity.subdivide(made, cells=1)
        self.group = "surface" if scene == BETWEEN_SURFACES else "patch"

    def run(self, size: float, seed: int):
        """Factors, and CPU seconds."""
        begun = used()
        found = self.package.view_factors(self.patches, rays=size, group=self.group, method=self.method, seed=seed)
        found = found if found.restoration else found.restored()
        return found.matrix, used() - begun


class Rows(Ours):
    """Some rows for a reference: exact factors of polygons times visible shares. A size is rays of a pair and replicate."""

    REPLICATES = 8

    def __init__(self, scene: str, _):
        super().__init__(scene, "polygons")
        self.rows = np.arange(0, len(self.patches), STEPS.get(scene, 1))

    def run(self, size: int, seed: int):
        """Factors of these rows, and CPU seconds."""
        from radiosity.device.backend import choose
        from radiosity.exchange.from_polygons import FacingPairs
        from radiosity.factors.polygons import exchange
        from radiosity.sampling.streams import Seed
        from radiosity.tracing.geometry import Geometry

        begun, n, corners = used(), len(self.patches), self.patches.corners
        one, other = np.repeat(self.rows, n), np.tile(np.arange(n), len(self.rows))
        values = np.concatenate([exchange(corners[np.full(n, row)], corners) for row in self.rows])
        values[one == other] = 0
        some, area = np.flatnonzero(values), self.patches.area
        pairs = FacingPairs(Geometry(self.patches, choose("auto")), one[some], other[some], values[some])
        rays = size * self.REPLICATES * len(some)
        values[some] *= pairs.shares((values[some] / area[one[some]]) ** 2, rays, self.REPLICATES, Seed(seed)).values
        return values.reshape(len(self.rows), n) / self.patches.area[self.rows, None], used() - begun


class Raystrack:
    """raystrack: a size is density, rays of a cell and replicates; row after row, which is the quickest with many surfaces.

    Where only some rows are judged it traces these, and the time is that of one row times the number of all.
    """

    def __init__(self, scene: str, _):
        import raystrack

        self.package = raystrack
        faces = mesh(SURFACES if scene == BETWEEN_SURFACES else CUTS[scene])
        label = faces.surface if scene == BETWEEN_SURFACES else np.arange(len(faces.area))
        halves = np.where(faces.triangle, 1, 2)
        meshes, order = {}, np.argsort(label, kind="stable")
        for number, some in enumerate(np.split(order, np.cumsum(np.bincount(label))[:-1])):
            corners = faces.corners[some].reshape(-1, 3).astype(np.float32)
            fans = [(4 * k, 4 * k + 1 + h, 4 * k + 2 + h) for k, i in enumerate(some) for h in range(halves[i])]
            meshes[str(number)] = raystrack.Mesh(corners, np.array(fans, np.int32))
        self.scene, self.count, self.step = raystrack.Scene.from_meshes(meshes), len(meshes), STEPS.get(scene, 1)

    def run(self, size: list[int], seed: int):
        """Factors of some rows, and CPU seconds of the whole scene."""
        rs, (density, each, replicates) = self.package, size
        options = rs.SolveOptions(
            sampling=rs.Sampling(density=density, rays_per_cell=each, seed=seed),
            accuracy=rs.Accuracy(max_replicates=replicates, min_replicates=replicates, tolerance=0.0),
        )
        n, step = self.count, self.step
        with rs.Solver(self.scene, device="cpu", bvh="builtin") as solver:
            if step > 1:  # the tree is built, and not timed
                solver.solve(rs.Query.row("0", receiver_sides=("front",)), options)
            begun = used()
            if n <= len(NAMES):
                factors = solver.solve(rs.Query.matrix(receiver_sides=("front",)), options).dense(unknown=0.0)[:, :n]
            else:
                queries = [rs.Query.row(str(i), receiver_sides=("front",)) for i in range(0, n, step)]
                factors = np.array([solver.solve(query, options).dense(unknown=0.0)[0, :n] for query in queries])
            return factors, (used() - begun) * n / len(factors)


class Pyviewfactor:
    """pyviewfactor, the cylinder its obstacle; a size is by how much each face is cut finer. Its F is transposed back."""

    def __init__(self, scene: str, _):
        import pyviewfactor
        import pyvista

        self.package, self.cut = pyviewfactor, SURFACES if scene == BETWEEN_SURFACES else CUTS[scene]
        faces = mesh(self.cut)
        self.label = faces.surface if scene == BETWEEN_SURFACES else np.arange(len(faces.area))
        self.pyvista, whole = pyvista, mesh(SURFACES)
        body = whole.surface >= NAMES.index("side")
        self.obstacle = self._polygons(Mesh(whole.corners[body], whole.surface[body])).triangulate()

    def _polygons(self, faces: Mesh):
        corners = np.where(faces.triangle, 3, 4)
        points = np.concatenate([some[:k] for some, k in zip(faces.corners, corners, strict=True)])
        first = np.cumsum([0, *corners[:-1]])
        return self.pyvista.PolyData(points, np.concatenate([[k, *range(i, i + k)] for k, i in zip(corners, first, strict=True)]))

    def run(self, size: int, _seed: int):
        """Factors, and CPU seconds."""
        finer = mesh(self.cut.finer(size))
        polygons, group = self._polygons(finer), self.label[parents(self.cut, size)]
        begun = used()
        factors = self.package.compute_viewfactor_matrix(polygons, obstacles=self.obstacle).T
        return grouped(factors, finer.area, group), used() - begun


PROGRAMS = {"radiosity": Ours, "rows": Rows, "raystrack": Raystrack, "pyviewfactor": Pyviewfactor}


class Worker:
    """What answers."""

    def __init__(self, scene: str, program: str):
        name, _, self.method = program.partition("/")
        self.program, self.step = PROGRAMS[name](scene, self.method), STEPS.get(scene, 1)

    def run(self, size, seed: int) -> tuple[np.ndarray, float]:
        """The rows that are judged, and CPU seconds of the whole scene."""
        factors, cpu = self.program.run(size, seed)
        return factors[:: self.step] if len(factors) == factors.shape[1] else factors, cpu

    def warm(self, size) -> dict:
        """Run once between surfaces, so that everything is loaded and compiled."""
        type(self.program)(BETWEEN_SURFACES, self.method).run(size, 0)
        return {}

    def measure(self, size, seed: int, reference: str) -> dict:
        """CPU seconds, and the square of the error against a reference."""
        factors, cpu = self.run(size, seed)
        return {"cpu": cpu, "square": square(factors, np.load(reference)["matrix"])}

    def keep(self, size, seed: int, file: str) -> dict:
        """Two long runs: their mean, and its variance from their difference."""
        one, cpu = self.run(size, seed)
        two, more = self.run(size, seed + 1000)
        mean, variance = (one + two) / 2, square(one, two) / 4
        part = Path(file).with_suffix(".part.npz")
        np.savez(part, matrix=mean, variance=variance)
        part.replace(file)
        return {"cpu": cpu + more, "variance": variance}


def main() -> None:
    """Answer until the input ends; what libraries print goes to standard error."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    warnings.simplefilter("ignore")
    worker = None
    for line in sys.stdin:
        asked = json.loads(line)
        try:
            worker = worker or Worker(*sys.argv[1:3])
            answer = getattr(worker, asked.pop("do"))(**asked)
        except (ImportError, MemoryError, ValueError) as error:
            answer = {"refused": " ".join(str(error).split())}
        print(json.dumps(answer), file=answers, flush=True)


if __name__ == "__main__":
    main()
