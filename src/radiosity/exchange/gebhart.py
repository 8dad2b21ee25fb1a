"""Gebhart factors: the share of what a group emits that another absorbs, after all reflections.

B. Gebhart, "Surface temperature calculations in radiant surroundings of arbitrary complexity", International Journal of Heat and
Mass Transfer 3, 1961. Every group emits in turn, in proportion to the emissivity of its patches, and the counted lines carry it:
one solution a group and replicate. Where that is less work, one factorisation a replicate serves all groups (`factors.direct`).
The lines carry power from where they begin, so that all of it ends somewhere: rows, with what escapes and is lost, sum to one.
The conductor e_i A_i G_ij of a pair is the same both ways as far as counts are reciprocal.
"""

from dataclasses import dataclass, replace

import numpy as np

from ..device import memory
from ..device.backend import choose
from ..errors import MethodError, SceneError, shown
from ..factors.counted import CountedPairs
from ..factors.direct import Direct, is_quicker
from ..patches.model import Patches
from ..patches.scatter import Scatter
from ..patches.values import of_sides
from ..run.line_set.model import LineSet
from ..solution.csv_rows import write_rows
from ..solution.errors import mean_and_error
from ..tracing.geometry import Geometry
from .conditions import by_name
from .few_shares import least_errors
from .groups import Groups, groups_of
from .narrow import warn_of_narrow
from .panes import of_solid

ESCAPED, LOST = "(escaped)", "(lost)"
AT_ONCE = 16  # groups that emit in one call of the solver


@dataclass(frozen=True, eq=False, repr=False)
class GebhartFactors:
    """The share G_ij of what group i emits that group j absorbs, after all reflections. `gebhart_factors` makes them.

    Every row, with escaped and lost, sums to one.

    Attributes:
        names: the names of the n groups.
        area: (n,) m², radiating sides alone.
        emissivity: (n,) means over the area of each group.
        values: (n, n + 2) shares; the last two columns are escaped and lost.
        errors: (n, n + 2) standard errors; NaN: unknown, since there is one replicate. Where no line joined two groups it is at
            least one line's worth, and zero only where they cannot see each other.
        replicates: independent randomised runs.

    Example:
        >>> lines = rd.trace_lines(rd.subdivide(rd.load_scene("room"), cells=1), rays=100_000)
        >>> shares = rd.gebhart_factors(lines, emissivity=0.8)
        >>> shares.matrix.shape, bool(abs(shares.values.sum(axis=1) - 1).max() < 1e-8)
        ((10, 10), True)
    """

    names: tuple[str, ...]
    area: np.ndarray
    emissivity: np.ndarray
    values: np.ndarray
    errors: np.ndarray
    replicates: int

    def __repr__(self) -> str:
        """The factors in two lines."""
        worst = f"{self.errors.max(initial=0.0):.2g}" if self.replicates > 1 else "unknown (one replicate)"
        return f"Gebhart factors between {len(self.names):,} groups: {shown(self.names, 6)}\n  largest standard error {worst}"

    @property
    def matrix(self) -> np.ndarray:
        """G_ij in row i, (n, n)."""
        return self.values[:, :-2]

    @property
    def standard_error(self) -> np.ndarray:
        """Standard errors of `matrix`, (n, n)."""
        return self.errors[:, :-2]

    @property
    def conductors(self) -> np.ndarray:
        """Radiative conductors GR_ij = e_i A_i G_ij, (n, n) m²: the heat from i to j is sigma GR_ij (T_i⁴ - T_j⁴)."""
        return (self.emissivity * self.area)[:, None] * self.matrix

    @property
    def _told(self) -> np.ndarray:
        """Entries that a file holds, (n, n + 2) bool."""
        some = self.values != 0
        some[:, :-2] |= self.errors[:, :-2] > 0
        return some

    def to_csv(self, path) -> None:
        """Write a CSV file with a row for each pair that may exchange heat: shares and conductors (m²), with standard errors.

        A pair that no line joined is there with its error. What escapes, or is lost on backs, is a conductor to ``(escaped)`` or
        ``(lost)``.

        Raises:
            OutputError: the file cannot be written.

        Example:
            >>> lines = rd.trace_lines(rd.load_scene("room"), rays=10_000)
            >>> rd.gebhart_factors(lines, emissivity=0.9, group={"all": ["*"]}).to_csv("conductors.csv")
        """
        columns, whole = [*self.names, ESCAPED, LOST], self.emissivity * self.area
        rows = [
            {
                "from": self.names[i],
                "to": columns[j],
                "Gebhart factor": float(self.values[i, j]),
                "standard error": float(self.errors[i, j]),
                "conductor m²": float(whole[i] * self.values[i, j]),
                "conductor standard error m²": float(whole[i] * self.errors[i, j]),
            }
            for i, j in zip(*np.nonzero(self._told), strict=True)
        ]
        write_rows(rows, path)


def gebhart_factors(lines: LineSet, *, emissivity, group="surface") -> GebhartFactors:
    """Return the shares of what groups emit that others absorb, after all reflections. No line is traced.

    Surfaces are diffuse and grey, and each group has one temperature. Irradiance is taken as uniform over each patch, not over a
    group: cut large surfaces into several patches.

    Args:
        lines: what `trace_lines` has counted.
        emissivity: one number above 0 and at most 1, a dictionary of names of surfaces (or patterns) to numbers, which must name
            every surface (in place of a number it may hold sides, ``{"front": 0.05, "back": 0.8}``), or a number for each patch.
            An exact name goes before a pattern, and that before ``"*"``.
        group: as of `view_factors`.

    Raises:
        MethodError: no lines, a group or surface that does not exist, a surface without an emissivity, a patch without lines, or
            more groups than fit in memory. SceneError: an emissivity out of range, or two
            patterns that give a surface unlike ones.

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=1)
        >>> lines = rd.trace_lines(patches, rays=100_000)
        >>> shares = rd.gebhart_factors(lines, emissivity={"*": 0.9, "floor": 0.5}, group={"walls": ["*wall"]})
        >>> shares.names[0], bool(shares.conductors[0, 0] > 0)
        ('walls', True)
    """
    if not isinstance(lines, LineSet):
        raise MethodError(f"gebhart_factors takes a LineSet, not {type(lines).__name__}; count lines with trace_lines")
    patches, groups = lines.patches, groups_of(lines.patches, group)
    share = _emissivities(patches, emissivity)
    solid = of_solid(patches, share)
    n, replicates = len(groups.names), lines.replicates
    memory.refuse(8.0 * (replicates + 4) * n * (n + 2), f"Gebhart factors of {n} groups", "take fewer groups")
    if not lines.pairs.lines.all():
        without = patches.scene.names[patches.surface[int(np.argmin(lines.pairs.lines.min(axis=0)))]]
        raise MethodError(
            f"a patch of '{without}' has no lines in some replicate, and cannot pass on what it reflects: take more rays"
        )
    if lines.method.lines == "local":
        warn_of_narrow(Geometry(patches, choose("auto")), groups)
    carried = replace(lines.pairs, directed=True)  # from where lines begin: all that is sent ends somewhere
    factors = len(carried.keys) * (2 if carried.both_ways else 1) // replicates
    if is_quicker(len(patches), factors, n, 1 - solid):
        values, bias = _at_once(carried, groups, solid)
    else:
        values, bias = np.zeros((replicates, n, n + 2)), np.zeros((n, n + 2))
        for begin in range(0, n, AT_ONCE):
            some = np.arange(begin, min(begin + AT_ONCE, n))
            values[:, some], bias[some] = _absorbed(carried, groups, solid, some)
    mean, error = mean_and_error(values)
    area = groups.area(patches)
    return GebhartFactors(
        groups.names,
        area,
        np.bincount(groups.labels, share * patches.area, n) / area,
        mean,
        least_errors(carried, groups, solid, mean, np.hypot(error, bias)),
        replicates,
    )


def _absorbed(pairs: CountedPairs, groups: Groups, share: np.ndarray, some: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what is absorbed of the emission of some groups, (replicates, k, n + 2), and the size of its bias, (k, n + 2)."""
    area, labels, n = pairs.patches.area, groups.labels, len(groups.names)
    emission = np.where(labels[:, None] == some, share[:, None], 0.0)
    emitted = area @ emission
    values, bias = np.zeros((pairs.replicates, len(some), n + 2)), np.zeros((len(some), n + 2))
    for k, found in enumerate(pairs.solve(emission, Scatter(np.repeat(1 - share[:, None], len(some), axis=1)))):
        for replicate, (power, missed) in enumerate(zip(found.power, found.missed, strict=True)):
            values[replicate, k, :n] = np.bincount(labels, share * power, n) / emitted[k]
            values[replicate, k, n:] = missed / emitted[k]
        bias[k, :n] = np.bincount(labels, share * found.bias.mean(axis=0), n) / emitted[k]
    return values, bias


def _at_once(pairs: CountedPairs, groups: Groups, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return what `_absorbed` does, of all groups, by one factorisation a replicate."""
    from scipy.sparse import csr_array

    area, n, count = pairs.patches.area, len(groups.names), len(share)
    member = csr_array((np.ones(count), groups.labels, np.arange(count + 1)), shape=(count, n))
    emission, reflectance = (member * share[:, None]).toarray(), 1 - share
    emitted = area @ emission
    values, bias = np.zeros((pairs.replicates, n, n + 2)), np.zeros((n, n + 2))
    for into, lines, factors in zip(values, pairs.lines, pairs.factors(), strict=True):
        solver = Direct(factors.sent(area), reflectance)
        received = solver.irradiance(emission)
        sent = area[:, None] * (emission + reflectance[:, None] * received)
        absorbed = member.T * (share * area)
        into[:, :n] = (absorbed @ received).T
        into[:, n], into[:, n + 1] = factors.escaped @ sent, factors.lost @ sent
        into /= emitted[:, None]
        off = solver.of_own_light(area, lines, emission, received, both_ways=pairs.both_ways)
        bias[:, :n] += (absorbed @ off).T / emitted[:, None] / pairs.replicates
    return values, bias


def _emissivities(patches: Patches, given) -> np.ndarray:
    """Return the emissivity of each patch, (n_patches,).

    Raises:
        MethodError: a surface that does not exist, or one without an emissivity. SceneError: a value out of range.
    """
    names = patches.scene.names
    if isinstance(given, dict):
        result = np.full(len(patches), np.nan)
        for i, (value, _) in by_name(given, list(names), "emissivity").items():
            for rows, one in of_sides(patches, patches.surface == i, value, "emissivity", names[i]):
                result[rows] = _number(one, names[i])
        lacking = [names[s] for s in np.unique(patches.surface[np.isnan(result)])]
        if lacking:
            raise MethodError(
                f"emissivity: none is given for {shown(lacking)}, or for one side; name them, or '*' for all others"
            )
        return result
    values = np.asarray(given, dtype=object)
    if values.ndim == 0:
        return np.full(len(patches), _number(given, "all surfaces"))
    if values.shape != (len(patches),):
        raise MethodError(
            f"emissivity has shape {values.shape}; give one number, a dictionary by names of surfaces, or ({len(patches)},) for "
            "patches"
        )
    return np.array([_number(value, names[s]) for value, s in zip(values, patches.surface, strict=True)])


def _number(value, name) -> float:
    try:
        number = float("nan") if isinstance(value, bool | np.bool) else float(value)
    except (TypeError, ValueError):
        number = float("nan")
    if not 0 < number <= 1:
        raise SceneError(f"emissivity of {name} is {value!r}; it must be above 0 and at most 1")
    return number
