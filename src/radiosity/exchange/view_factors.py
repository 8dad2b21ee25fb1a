"""View factors between groups of surfaces, with what escapes and what is lost, and with errors."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ..device import memory
from ..errors import printable, shown
from ..solution.intervals import FEW, count_bounds, student
from .restoration import RAW


@dataclass(frozen=True, eq=False, repr=False)
class ViewFactors:
    """The share F_ij of what leaves group i that arrives at group j. `view_factors` makes them.

    The entries are sparse. Their columns are the n groups, then n (escaped: it leaves the scene) and n + 1 (lost: it ends on
    backs that do not radiate). Every row, with escaped and lost, sums to one.

    Attributes:
        names: the names of the n groups.
        area: (n,) m², radiating sides alone.
        rows, columns: (m,) int64, ascending.
        values: (m,) shares, in [0, 1].
        errors: (m,) standard errors; NaN: unknown, since there is one replicate.
        replicates: independent randomised runs.
        samples: (replicates, m) the values of each replicate; None where there are too many groups to keep them.
        line: (n,) the largest share that a line of a group makes, all replicates together; NaN where no lines were counted.
        hits: (m,) int64, lines that were counted, all replicates together; -1: the value does not come from counts.
        apart: (k,) int64, ascending, row * n + column of groups that cannot see each other, where that was found out.
        method: "lines" or "polygons".
        reciprocal: False where backs let lines pass, so that A_i F_ij and A_j F_ji may differ.
        restoration: "" (as measured), "least squares" or "scaling": how reciprocity was restored.
        rays: lines that were traced, all replicates together.
        status: "complete", "interrupted" (there are fewer lines than were asked for), or "not reached" (the error asked for).
        provenance: what the factors were made of.

    Example:
        >>> factors = rd.view_factors(rd.load_scene("room"), rays=200_000, group={"walls": ["*wall"]})
        >>> factors.names[0], factors.matrix.shape, bool(abs(factors.row_sums - 1).max() < 1e-12)
        ('walls', (7, 7), True)
    """

    names: tuple[str, ...]
    area: np.ndarray
    rows: np.ndarray
    columns: np.ndarray
    values: np.ndarray
    errors: np.ndarray
    replicates: int
    samples: np.ndarray | None
    line: np.ndarray
    hits: np.ndarray
    apart: np.ndarray = field(default_factory=lambda: np.zeros(0, np.int64))
    method: str = "lines"
    reciprocal: bool = True
    restoration: str = RAW
    rays: int = 0
    status: str = "complete"
    provenance: dict = field(default_factory=dict)

    def __len__(self) -> int:
        """Return the number of groups."""
        return len(self.names)

    def __repr__(self) -> str:
        """The factors in four lines."""
        by = "lines" if self.method == "lines" else "polygons and visible shares, rays"
        worst = f"{self.errors.max(initial=0.0):.2g}" if self.replicates > 1 else "unknown (one replicate)"
        how = "as measured" if self.restoration == RAW else f"restored by {self.restoration}"
        return "\n".join(
            [
                f"View factors between {len(self):,} groups: {printable(shown(self.names, 6))}",
                f"  made by     {by}: {self.rays:,} in {self.replicates} replicates, status: {self.status}",
                f"  rows        {how}; largest standard error {worst}",
                f"  missed      at most {self.escaped.max():.2g} of a row escapes, and {self.lost.max():.2g} is lost on backs",
            ]
        )

    @cached_property
    def matrix(self) -> np.ndarray:
        """F_ij in row i, (n, n)."""
        return self._dense(self.values)[:, : len(self)]

    @cached_property
    def standard_error(self) -> np.ndarray:
        """Standard errors of `matrix`, (n, n); NaN where unknown.

        Where no line went from i to j it is the share of one line, and zero only where the two cannot see each other.
        """
        return self._all_errors[:, : len(self)]

    @cached_property
    def escaped(self) -> np.ndarray:
        """The share of what leaves each group that leaves the scene, (n,)."""
        return self._column(len(self), self.values)

    @cached_property
    def lost(self) -> np.ndarray:
        """The share of what leaves each group that ends on backs that do not radiate, (n,)."""
        return self._column(len(self) + 1, self.values)

    @cached_property
    def escaped_standard_error(self) -> np.ndarray:
        """Standard errors of `escaped`, (n,)."""
        return self._column_error(len(self))

    @cached_property
    def lost_standard_error(self) -> np.ndarray:
        """Standard errors of `lost`, (n,)."""
        return self._column_error(len(self) + 1)

    @property
    def row_sums(self) -> np.ndarray:
        """The sum of each row, escaped and lost among it, (n,): one up to rounding."""
        return np.bincount(self.rows, self.values, len(self))

    def interval(self, level: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
        """Return lower and upper ends that hold the true F_ij with this probability, (n, n + 2) each; NaN where unknown.

        The last two columns are escaped and lost. From 30 lines on they are Student's, from replicates. With fewer they go to
        Garwood's bounds of a count (`docs/errors.md`): up to 3.7 lines where no line went from i to j.

        Raises:
            MethodError: a level outside (0, 1).
        """
        n, half = len(self), student(level, self.replicates)
        values, error = self._dense(self.values), self._all_errors
        low, high = np.maximum(values - half * error, 0), np.minimum(values + half * error, 1)
        hits, counted = self._dense(self.hits), self.method == "lines"
        few = (hits < FEW) & counted
        if few.any():
            codes = np.arange(n)[:, None] * (n + 2) + np.arange(n + 2)
            share = np.where(self._is_apart(codes), 0.0, self._share_of_a_line(*np.divmod(codes, n + 2)))
            least, most = count_bounds(hits, 0.5 + level / 2)
            low = np.where(few, np.fmin(low, least * share), low)
            high = np.where(few, np.fmax(high, np.minimum(most * share, 1)), high)
        return low, high

    def sparse(self):
        """Return `matrix` as an (n, n) scipy CSR array; pairs that no line joined have no entry."""
        from scipy.sparse import csr_array

        n, some = len(self), self.columns < len(self)
        first = np.concatenate([[0], np.cumsum(np.bincount(self.rows[some], minlength=n))])
        return csr_array((self.values[some], self.columns[some].astype(np.int32), first), shape=(n, n))

    def restored(self) -> "ViewFactors":
        """Return the nearest factors that are reciprocal and close: A_i F_ij = A_j F_ji, rows sum to one, none is negative.

        Both directions of each pair are weighted by their errors. See `exchange.restored`.

        Raises:
            MethodError: backs let lines pass, so that the true factors are not reciprocal.

        Example:
            >>> factors = rd.view_factors(rd.load_scene("room"), rays=100_000).restored()
            >>> exchange = factors.area[:, None] * factors.matrix
            >>> bool(abs(exchange - exchange.T).max() < 1e-12), factors.restoration
            (True, 'least squares')
        """
        from .restored import restored

        return restored(self)

    def to_csv(self, path, *, layout: str = "matrix") -> None:
        """Write a CSV file; see `exchange.factor_csv`.

        Args:
            path: the file to write.
            layout: "matrix" (a row for each group) or "long" (a row for each pair).

        Example:
            >>> import tempfile, pathlib
            >>> path = pathlib.Path(tempfile.mkdtemp()) / "room.csv"
            >>> rd.view_factors(rd.load_scene("room"), rays=10_000).to_csv(path)
            >>> path.read_text(encoding="utf-8").splitlines()[0][:27]
            'surface,area m²,south wall,'
        """
        from .factor_csv import write

        write(self, path, layout)

    def to_npz(self, path) -> None:
        """Write all there is to an NPZ file, for `load_view_factors`."""
        from .factor_file import save

        save(self, path)

    def to_energyplus(self, path, *, zone: str) -> None:
        """Write an EnergyPlus object ``ZoneProperty:UserViewFactors:BySurfaceName``; see `exchange.energyplus`."""
        from .energyplus import write

        write(self, path, zone)

    def _column(self, column: int, values: np.ndarray) -> np.ndarray:
        here = self.columns == column
        return np.bincount(self.rows[here], values[here], len(self))

    def _column_error(self, column: int) -> np.ndarray:
        met = self._column(column, np.ones(len(self.rows))) > 0
        return np.where(
            met, self._column(column, self.errors), self._unmet_error(np.arange(len(self)), np.full(len(self), column))
        )

    @cached_property
    def _all_errors(self) -> np.ndarray:
        """Standard errors of all entries, (n, n + 2)."""
        n = len(self)
        codes = np.arange(n)[:, None] * (n + 2) + np.arange(n + 2)
        result = self._unmet_error(*np.divmod(codes, n + 2))
        result[self.rows, self.columns] = self.errors
        return result

    def _unmet_error(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return standard errors where no line went: the share of one line; zero where none can, or where nothing is missed."""
        if self.replicates < 2:
            return np.where(self._is_apart(rows * (len(self) + 2) + columns), 0.0, np.nan)
        share = self._share_of_a_line(rows, columns)
        return np.where(self._is_apart(rows * (len(self) + 2) + columns), 0.0, np.nan_to_num(share))

    def _share_of_a_line(self, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Return the share that one line makes of an entry. Where both directions count it is 1 / (w_i + w_j) / A_i."""
        n, own = len(self), self.line[rows]
        if self.restoration == RAW:
            return own
        other = np.minimum(columns, n - 1)
        back = self.line[other] * self.area[other] / self.area[rows]
        return np.where(columns < n, 1 / (1 / own + 1 / back), own)

    def _is_apart(self, codes: np.ndarray) -> np.ndarray:
        n = len(self)
        rows, columns = np.divmod(codes, n + 2)
        return (columns < n) & np.isin(rows * n + columns, self.apart)

    def _dense(self, values: np.ndarray) -> np.ndarray:
        """Return entries as an (n, n + 2) array.

        Raises:
            MethodError: it does not fit in memory.
        """
        n = len(self)
        memory.refuse(
            8.0 * n * (n + 2), f"a full matrix of {n} groups", "take .sparse(), .rows, .columns and .values, or fewer groups"
        )
        result = np.zeros((n, n + 2), values.dtype)
        result[self.rows, self.columns] = values
        return result
