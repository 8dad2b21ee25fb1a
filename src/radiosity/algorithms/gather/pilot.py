"""The pilot of a gather: a few lines of every patch, of no replicate, which say where lines are needed and are then forgotten.

It is a function of the scene and the seed. So the shares of lines do not depend on what the replicates find, which keeps
their means unbiased, and parts of a run share their lines out alike.
"""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from ...method import Method
from ...patches.bases import BASES
from ...problem.model import Problem
from ...sampling.streams import Purpose, Seed
from ...tracing.geometry import Geometry
from .chances import Chances
from .lane_scatter import LaneScatter
from .lines import Lines
from .packets import Packets
from .rows import Rows
from .shares import Shares
from .stored_lines import StoredLines

STORED, READ, SHADOW = 8, 4, 4  # cosine lines that give a first solution, those that read it, and shadow rays
LINES = STORED + READ + SHADOW  # of each patch
BLACK = 0.25  # of the mean reflectance: least weight of a patch, since its irradiance is a result, too
TOLERANCE = 0.02  # of the mean


@dataclass(frozen=True, eq=False)
class Pilot:
    """What a pilot found.

    Attributes:
        shares: the plan for lines.
        variance: (2, n_patches) float64, of cosine lines and shadow rays, of the largest group of bands; with a basis the sum of
            those of its coefficients.
        irradiance: (n_patches, n_groups) float64, a rough solution, in shares of the largest emission.
    """

    shares: Shares
    variance: np.ndarray
    irradiance: np.ndarray

    @staticmethod
    def of(geometry: Geometry, problem: Problem, chances: Chances, method: Method, seed: Seed | int) -> "Pilot":
        """Return the pilot of a scene and seed; it is run once.

        Args:
            method: its numbers and their randomisation.
        """
        key = ("pilot", method.points, method.randomisation, method.basis, Seed.of(seed).value)
        if key not in geometry.made:
            geometry.made[key] = Pilot.run(geometry, problem, chances, method, seed)
        return geometry.made[key]

    @staticmethod
    def run(geometry: Geometry, problem: Problem, chances: Chances, method: Method, seed: Seed | int) -> "Pilot":
        """Trace `LINES` lines of each patch.

        Args:
            method: its numbers and their randomisation.
        """
        packets = Packets(geometry, 1)
        lines = Lines.of(packets, chances, problem, method, Seed(Seed.of(seed).value), (Purpose.PILOT, Purpose.PILOT_SHADOW))
        types, groups = packets.types, lines.groups
        constant = lambda value: np.full(packets.count, value)  # noqa: E731
        shadow = lines.shadow(constant(0), constant(SHADOW), squares=True)
        kept, size = StoredLines(packets, count=STORED), BASES[method.basis].size
        lamplight, _ = lines.cosine(constant(0), constant(STORED), keep=kept)
        rows = Rows(
            packets, kept, dr.full(types.UInt32, STORED, packets.lanes), LaneScatter.of_lanes(packets, problem.groups.scatter)
        )
        direct = [
            total * (1 / SHADOW) + types.Float(met) * (1 / lines.unit / STORED)
            for total, met in zip(shadow, lamplight, strict=False)
        ]
        right = rows.scatter.of(direct)
        dr.eval(right, direct)
        level = max(float(np.mean(np.array(one))) for one in direct)
        reflected, _ = rows.solve(right, TOLERANCE * max(level, 1e-30))
        cosine, _ = lines.cosine(constant(STORED), constant(READ), read=reflected, squares=True)
        variance = np.stack([_variance(packets, sums, number, size) for sums, number in ((cosine, READ), (shadow, SHADOW))])
        rho = problem.groups.scatter.albedo.max(axis=1)
        area = packets.patches.area
        importance = area * np.maximum(rho, BLACK * float(rho @ area) / float(area.sum())) ** 2 if rho.any() else area
        whole = [np.array(a + types.Float(b)) for a, b in zip(direct, rows.means(reflected), strict=True)]
        irradiance = np.stack([packets.patch_values(one)[0] for one in whole], axis=-1).astype(np.float64)
        return Pilot(Shares.of(packets, variance, importance, size), variance, irradiance[:, :groups])


def _variance(packets: Packets, sums: list, number: int, size: int) -> np.ndarray:
    """Return the variance of one line of each patch, (n_patches,), the largest of the groups, from sums and sums of squares.

    A function has the mean square 1. So what one line says of its coefficient has about the mean square of what it finds.
    """
    half = len(sums) // 2
    found = []
    for total, square in zip(sums[:half], sums[half:], strict=True):
        mean = packets.patch_values(np.array(total, np.float64))[0] / number
        of_squares = packets.patch_values(np.array(square, np.float64))[0] / number
        found.append(np.maximum(of_squares - mean**2, 0) * number / (number - 1) + (size - 1) * of_squares)
    return np.max(found, axis=0)
