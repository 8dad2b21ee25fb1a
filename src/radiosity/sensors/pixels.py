"""The light at points of surfaces that a picture shows: a final gather at each of them."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..device.backend import choose
from ..device.turn import turn
from ..problem.model import Problem
from ..run.budget import Budget
from ..run.progress import Listener, Teller
from ..run.whole_number import whole
from ..sampling.streams import Seed
from ..scene.habits import warn
from ..solution.model import Solution
from ..tracing.geometry import Geometry
from .bright import with_bright
from .model import Sensors
from .reflected import mean_reflected
from .result import in_bands
from .run import AT_ONCE, sensing_on
from .shares import PILOT
from .tracing import Tracing

PIECE = 1 << 18  # points at once
OF_PILOT = 8  # a pilot takes one line of so many; where those are too few there is none


@dataclass(eq=False)
class Gather:
    """A final gather at points of patches, which reads a solution.

    Attributes:
        solution: that lines read, in the mean over its replicates.
        geometry, problem: of its scene.
        light: (n_patches, n_columns) what patches reflect, in shares of the unit of light, see `mean_reflected`.
        lines: of each point, both kinds together.
        seed: that all numbers follow from.
        teller: of progress.
        cluster: a client of workers that trace the lines; None: here.
        pieces: of points so far; each has numbers of its own.
    """

    solution: Solution
    geometry: Geometry
    problem: Problem
    light: np.ndarray
    lines: float
    seed: int
    teller: Teller
    cluster: Any = None
    pieces: int = field(default=0)

    @staticmethod
    def of(
        solution: Solution,
        lines: float,
        points: int,
        *,
        seed: int = 0,
        device: str = "auto",
        progress: Listener | None = None,
        cluster: Any = None,
    ) -> "Gather":
        """Prepare a gather.

        Args:
            lines: of each point.
            points: how many there are at most; progress is told as a part of them.
            cluster: a client of workers, see `run.on_cluster`.

        Raises:
            DeviceError: rays cannot be traced here.
        """
        number = whole(seed, "seed", 0)
        geometry = Geometry(solution.patches.solid, choose(device))
        problem = Problem.of(solution.patches)
        light = mean_reflected(solution, problem)
        if unknown := int(np.isnan(light).any(axis=1).sum()):
            warn(f"{solution.patches.scene.source}: the light of {unknown} patches is unknown; a final gather takes it as 0")
        teller = Teller(Budget(rays=max(lines * points, 1)), progress)
        teller.begin(0)
        problem, light = with_bright(solution, problem, np.nan_to_num(light))
        return Gather(solution, geometry, problem, light, lines, number, teller, cluster)

    def irradiance(self, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return what falls on points of patches, (m, n_bands) float64, W/m² or lx.

        Args:
            patch: (m,) on whose side each lies.
            u, v: (m,) face coordinates.
        """
        return self.with_backs(patch, u, v)[0]

    def with_backs(self, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return what falls on points, as `irradiance` does, and the share of cosine lines that met absorbing backs, (m,)."""
        parts = [self._piece(*(a[at : at + PIECE] for a in (patch, u, v))) for at in range(0, len(patch), PIECE)]
        if not parts:
            return np.zeros((0, len(self.solution.bands))), np.zeros(0)
        light, behind = zip(*parts, strict=True)
        return np.concatenate(light), np.concatenate(behind)

    @turn()
    def _piece(self, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        patches, seed = self.solution.patches, Seed(self.seed, first_replicate=self.pieces)
        face = patches.face[patch]
        low_u, low_v, size_u, size_v = self.geometry.starts[:, face]  # so that no line begins behind a neighbour
        origin, first, second = (edge[face] for edge in patches.scene.frames)
        places = origin + (low_u + size_u * u)[:, None] * first + (low_v + size_v * v)[:, None] * second
        pilot = min(int(self.lines / (2 * OF_PILOT)), PILOT)
        pilot = pilot if pilot > 1 else 0
        tracing = Tracing.of(
            self.geometry,
            self.problem,
            _sensors(places, patches.normal[patch]),
            self.light[None],
            1,
            seed,
            faces=face,
            pilot=pilot,
        )
        each, done, before = max(self.lines - 2 * pilot, 2.0), 0.0, self.teller.lines
        with sensing_on(self.cluster, tracing, self.problem, self.geometry.device.name):
            while done < each:
                done = min(done + max(AT_ONCE / len(patch), 1.0), each)
                tracing.advance(done)
                self.teller.lines = before + tracing.traced
                self.teller.tell("gathering")
        self.pieces += 1
        return in_bands(self.problem, tracing.values()[0]), tracing.behind()


def _sensors(points: np.ndarray, normals: np.ndarray) -> Sensors:
    """Return points of surfaces as sensors, however far away a scene lies."""
    n = len(points)
    return Sensors(points, normals, np.zeros(n, np.int64), ("points",), np.full((n, 2), -1), np.zeros(n, bool))
