"""The line set: lines counted between patches, replicates apart. It is made once and solves any emission and reflectance."""

from dataclasses import dataclass, replace
from pathlib import Path

from ...algorithms.matrix.state import MatrixState
from ...algorithms.matrix.tally import MatrixTally
from ...algorithms.state import Sizes
from ...device.backend import choose
from ...diagnostics.narrow import warn_of_light
from ...diagnostics.near_lamps import warn_of_near_lamps
from ...errors import SceneError, printable, shown
from ...factors.counted import CountedPairs
from ...method import Method
from ...patches import Patches
from ...patches.relit import relit
from ...problem.model import Problem
from ...solution.model import Solution
from ...tally import unmet
from ...tracing.geometry import Geometry
from ..part import Part
from ..record import Record
from ..shortfall import warn_of_few_ends
from ..snapshot import Snapshot
from .adding import fields_of_sum
from .lights import without_lights
from .saving import save_lines
from .starved import warn_of_starved


@dataclass(frozen=True, eq=False, repr=False)
class LineSet:
    """Lines counted between the patches of a scene; `radiosity.trace_lines` makes one. It depends on the geometry alone.

    Attributes:
        pairs: the counts, replicates apart; see `factors.counted.CountedPairs`.
        rays: lines traced in all. A span of a global line counts twice, once at each end.
        quanta: N of each replicate; ``trace_lines(..., quanta=N)`` repeats the counts bit for bit.
        seconds: wall time of tracing.
        status: "complete", "interrupted" or the reason for an early end. The lines so far are a whole set in any case.
        method: the kind of lines, and the numbers that they are made from.
        parts: the seeds and replicates of which it consists.
        sources: names of the surfaces that got more lines.
        provenance: hash of the geometry, method, seed, versions.

    Example:
        >>> lines = rd.trace_lines(rd.subdivide(rd.load_scene("room"), cells=2), rays=100_000)
        >>> day, evening = lines.solve(), lines.solve(emission={"light": 50.0, "floor": 1.0})
        >>> day.radiosity.shape, evening.status
        ((72, 1), 'complete')
    """

    pairs: CountedPairs
    rays: int
    quanta: int
    seconds: float
    status: str
    method: Method
    parts: tuple[Part, ...]
    sources: tuple[str, ...]
    provenance: dict

    @property
    def patches(self) -> Patches:
        """The patches that lines join, with the emission and reflectance of the scene."""
        return self.pairs.patches.whole

    @property
    def replicates(self) -> int:
        """Number of independent randomised sets of lines; from 2 on there are standard errors."""
        return self.pairs.replicates

    @property
    def seed(self) -> int:
        """The seed, of the first part where there are several."""
        return self.parts[0].seed.value

    @property
    def both_ways(self) -> bool:
        """True where each line counts at both its ends, and rows are balanced; see `one_way`."""
        return self.pairs.both_ways

    @property
    def one_way(self) -> "LineSet":
        """A set of the same lines, each counted where it begins alone: F_ij is n_ij / n_i, neither reciprocal nor balanced.

        Spans of global lines have two ends that begin, so they stay as they are.
        """
        return replace(self, pairs=replace(self.pairs, both_ways=False))

    @property
    def state(self) -> dict:
        """Arrays from which a run continues, and which files hold."""
        return self._state(1).arrays()

    def solve(self, emission=None, reflectance=None, *, bands=None) -> Solution:
        """Solve B = E + rho F B for any emission. No line is traced. Lights without area are left out, with a warning.

        Args:
            emission, reflectance: None is what the scene says. Else one number; an array (n_patches,) or (n_patches, n_bands);
                (n_surfaces,) or (n_surfaces, n_bands) in the order of the scene's names; or a dictionary from names of surfaces
                to a number or one for each band, which leaves other surfaces as they are. In place of a number it may hold a
                dictionary of sides: ``{"front": 100, "back": 0}``. An emission without a side is that of the sides that emit in
                the scene; where none does, of all that radiate. The number of bands may be another than the scene's.
            bands: names of the bands.

        Returns:
            The solution, with errors from the replicates. It holds no counts, so more lines come from the line set alone.

        Raises:
            SceneError: nothing emits, other shapes, or values out of range. MethodError: no such surface.
        """
        patches = relit(without_lights(self.patches), emission, reflectance, bands)
        if not patches.emission.any():
            raise SceneError(
                f"{patches.scene.source}: no surface emits; give an emission, such as "
                f"emission={{{patches.scene.names[patches.surface[0]]!r}: 100}}"
            )
        problem = Problem.of(patches)
        tally = MatrixTally(self.pairs.both_ways, directed=self.pairs.directed, pairs=self.pairs)
        snapshot = Snapshot(problem, tally, self._state(problem.groups.n_groups), self.replicates)
        part = Part(self.parts[0].seed, self.replicates)
        record = Record(patches, self.method, part, self.provenance["device"], self.provenance["budget"])
        solution = record.result(snapshot, self.status, snapshot.state, self.seconds)
        unmet.warn(patches, self.pairs.lines)
        if self.method.lines == "local":
            warn_of_starved(patches, self.pairs.lines)
            warn_of_light(Geometry(patches, choose("auto")), patches, stacklevel=2)
        warn_of_near_lamps(patches)
        warn_of_few_ends(self.method, self.rays / self.replicates / len(patches))
        return replace(solution, state={}, provenance=solution.provenance | {"line_set": self.provenance})

    def save(self, path) -> None:
        """Write an NPZ file that `radiosity.load_lines` reads.

        Raises:
            OutputError: the file cannot be written; one that was there stays as it was.
        """
        save_lines(self, Path(path))

    def __add__(self, other: "LineSet") -> "LineSet":
        """Return a set of all replicates of two, which have other replicates or other seeds, and equal quanta.

        Parts of one seed that follow each other become the set of one run, to the bit. Light is that of the first.

        Raises:
            MethodError: replicates overlap, or geometry, cut, sources, method, device or versions differ.
        """
        if not isinstance(other, LineSet):
            return NotImplemented
        return replace(self, **fields_of_sum(self, other))

    def __radd__(self, other: int) -> "LineSet":
        """Return the set itself where other is 0, with which `sum` begins."""
        return self if isinstance(other, int) and other == 0 else NotImplemented

    def _state(self, groups: int) -> MatrixState:
        sizes = Sizes(self.replicates, len(self.patches), groups)
        numbers = {"quanta": self.quanta, "reached": self.quanta, "replicates": self.replicates}
        return MatrixState(sizes=sizes, keys=self.pairs.keys, counts=self.pairs.counts, **numbers)

    def __repr__(self) -> str:
        """The line set in four lines."""
        scene = self.patches.scene
        seeds = ", ".join(f"seed {part.seed.value} replicates {part.range}" for part in self.parts)
        more = f", more of them from {printable(shown(self.sources, 4))}" if self.sources else ""
        counted = "each line counts at both ends" if self.both_ways else "lines count where they begin"
        return "\n".join(
            [
                f"Lines of {printable(scene.source)}: {len(self.patches):,} patches of {len(scene.names)} surfaces",
                f"  lines       {self.rays:,} in {self.seconds:.2f} s{more}, status: {self.status}",
                f"  made by     {self.method}, {seeds}",
                f"  pairs       {len(self.pairs.keys):,} in {self.replicates} replicates; {counted}",
            ]
        )
