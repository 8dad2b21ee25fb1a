"""What a comparison of two solutions found."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np

from ..patches.model import Patches
from .rows import Rows
from .significance import Test, any_of

OF = ("patches", "surfaces")
BINS = np.array([0.0, 1.0, 2.0, 3.0, 4.0, np.inf])  # of the sizes of normal scores


@dataclass(frozen=True, eq=False)
class PatchDifferences:
    """Values of both solutions on patches, or on the overlaps of their patches.

    Attributes:
        patches: the patches, or the overlaps (triangles and parallelograms).
        values: (2, k, n_bands).
        errors: (2, k, n_bands) standard errors; NaN where unknown, 0 of a reference.
        counted: (k,) bool, on sides that light reached in both solutions.
        tested: (k,) bool, counted ones that enough lines hit for a test.
        test: of each difference, (k, n_bands); NaN where it is not tested.
        equal: both solutions have these patches.
    """

    patches: Patches
    values: np.ndarray
    errors: np.ndarray
    counted: np.ndarray
    tested: np.ndarray
    test: Test
    equal: bool

    @property
    def difference(self) -> np.ndarray:
        """The first value less the second, (k, n_bands)."""
        return self.values[0] - self.values[1]


@dataclass(frozen=True, eq=False)
class Comparison:
    """The differences of two solutions, and whether their errors explain them; `radiosity.compare` returns one.

    Attributes:
        names: of the two solutions.
        quantity: "irradiance" or "radiosity".
        unit: of the values.
        bands: names of the bands.
        rows: means over surfaces and sides.
        by_patch: values of patches; None where the faces of the scenes differ.
        alpha: the probability with which two solutions that agree are called different.
        within: the largest relative difference that is allowed, or None: the errors decide.
        of: what ``within`` is of: "patches" (RMS) or "surfaces" (the largest).
        notes: what else the comparison found, a sentence each.

    Example:
        >>> patches = rd.subdivide(rd.load_scene("room"), cells=2)
        >>> one, two = (rd.solve(patches, rays=20_000, seed=seed) for seed in (1, 2))
        >>> found = rd.compare(one, two)
        >>> found.agrees, rd.compare(one, one).rms
        (True, 0.0)
    """

    names: tuple[str, str]
    quantity: str
    unit: str
    bands: tuple[str, ...]
    rows: Rows
    by_patch: PatchDifferences | None
    alpha: float
    within: float | None
    of: str
    notes: tuple[str, ...]

    @cached_property
    def rms(self) -> float:
        """The area-weighted RMS of the differences of patches (of surfaces and sides where faces differ), the largest of bands,
        in ``unit``."""
        return float(self._rms(self._pairs[0]).max())

    @cached_property
    def relative(self) -> float:
        """``rms`` over the RMS of the second solution, the largest of the bands; NaN where that is dark."""
        return self._over_second(self._pairs[0])

    @cached_property
    def expected(self) -> float:
        """What ``relative`` would be from the errors alone; NaN where they are unknown."""
        return self._over_second(self._pairs[1])

    @cached_property
    def largest(self) -> float:
        """The largest relative difference of the mean over a surface's side, of all bands; NaN where all are dark."""
        first, second = self.rows.values
        some = (first != 0) | (second != 0)
        with np.errstate(divide="ignore"):
            return float(np.max(np.abs(first - second)[some] / np.abs(second[some]))) if some.any() else float("nan")

    @cached_property
    def chance(self) -> float:
        """The probability that solutions that agree differ as much; NaN where no error is known.

        It is twice the smaller one of two: of the chi square of surfaces and sides, and, where the patches are equal, of the
        patch that differs most.
        """
        both = [self.rows.chance]
        if self.by_patch is not None and self.by_patch.equal:
            both.append(any_of(self.by_patch.test.chance))
        known = [one for one in both if np.isfinite(one)]
        return min(1.0, len(known) * min(known)) if known else self._exact()

    @cached_property
    def agrees(self) -> bool | None:
        """True where the differences are within the tolerance, or within the errors where there is none. None: unknown."""
        if self.within is not None:
            found = self.relative if self.of == "patches" else self.largest
            return found <= self.within if np.isfinite(found) or not self.rms > 0 else False
        return None if np.isnan(self.chance) else self.chance >= self.alpha

    @cached_property
    def surfaces(self) -> list[dict]:
        """A row for each surface, side and band: both means with errors, the difference, its score and its probability."""
        rows, result = self.rows, []
        for i, (surface, side) in enumerate(zip(rows.surface, rows.side, strict=True)):
            for j, band in enumerate(self.bands):
                (first, second), (one, two) = rows.values[:, i, j].tolist(), rows.errors[:, i, j].tolist()
                result.append(
                    {
                        "surface": surface,
                        "side": side,
                        "band": band,
                        "area": float(rows.area[i]),
                        "first": first,
                        "first error": one,
                        "second": second,
                        "second error": two,
                        "difference": first - second,
                        "relative": (first - second) / second if second else float("nan"),
                        "score": float(rows.test.score[i, j]),
                        "probability": float(rows.test.chance[i, j]),
                    }
                )
        return result

    def histogram(self) -> list[dict]:
        """Numbers of scores in each bin (of patches, or of surfaces and sides), beside those that errors alone would give.

        Scores below and above zero have the same bins. Zero has its own, "from" 0 "to" 0: there both values are equal, which no
        error makes likely.
        """
        from scipy.stats import norm

        test = self.rows.test if self.by_patch is None else self.by_patch.test
        known = test.score[np.isfinite(test.score)]
        below, above = (np.histogram(sizes[sizes > 0], BINS)[0] for sizes in (-known, known))
        expected = np.diff(norm.cdf(BINS)) * known.size
        ends = [*zip(-BINS[:0:-1], -BINS[-2::-1] + 0.0, strict=True), (0.0, 0.0), *pairwise(BINS)]
        counts = [*below[::-1], np.count_nonzero(known == 0), *above]
        return [
            {"from": float(low), "to": float(high), "count": int(count), "expected": float(usual)}
            for (low, high), count, usual in zip(ends, counts, [*expected[::-1], 0.0, *expected], strict=True)
        ]

    def report(self) -> str:
        """Return a summary in plain text."""
        from .report import report

        return report(self)

    def __repr__(self) -> str:
        return self.report()

    def save(self, path, **options) -> None:
        """Write .json (all figures), .csv (patches, and beside it surfaces), .png (a picture of the differences) or .svg and .pdf
        (their histogram), by the name's ending; options are those of `radiosity.comparison.outputs.write`."""
        from .outputs import write

        write(self, Path(path), **options)

    @cached_property
    def _pairs(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Differences, their errors, second values, (k, n_bands) each, and areas, (k,)."""
        if self.by_patch is None:
            rows = self.rows
            return rows.difference, np.sqrt((rows.errors**2).sum(axis=0)), rows.values[1], rows.area
        some = self.by_patch.counted
        both = np.sqrt((self.by_patch.errors[:, some] ** 2).sum(axis=0))
        return self.by_patch.difference[some], both, self.by_patch.values[1][some], self.by_patch.patches.area[some]

    def _rms(self, values: np.ndarray) -> np.ndarray:
        area = self._pairs[3]
        return np.sqrt(area @ values**2 / area.sum())

    def _over_second(self, values: np.ndarray) -> float:
        top, bottom = self._rms(values), self._rms(self._pairs[2])
        if not bottom.any():
            return float("nan") if top.any() else 0.0
        with np.errstate(divide="ignore", invalid="ignore"):
            return float(np.max(np.where((bottom == 0) & (top == 0), 0.0, top / bottom)))

    def _exact(self) -> float:
        """The probability where no error is known: equal values agree, whatever their errors."""
        return 1.0 if not self._pairs[0].any() else float("nan")
