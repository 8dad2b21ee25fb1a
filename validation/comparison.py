"""Differences and what they mean.

A value that is measured S times independently is compared by Student's t with S - 1 degrees of freedom. Patches of one run share
lines, so the sum of their squared differences over the stated variances (chi-square) is judged by flipping signs: were there no
difference but noise, those of one run, all patches together, could as well have the other sign. That needs neither independent
patches nor normal errors.
"""

from dataclasses import dataclass

import numpy as np

from .runs import Runs

ALPHA = 1e-3  # of a comparison: smaller p-values are called disagreements
FLIPS = 20_000


@dataclass(frozen=True)
class Value:
    """A number measured in independent runs, against an exact one.

    Attributes:
        name: what it is.
        exact, measured, error: the last is the standard error of the mean.
        runs: how many.
        note: what else is to be known, for the page.
        bound: by how much the exact value of what was measured may differ from ``exact``.
    """

    name: str
    exact: float
    measured: float
    error: float
    runs: int
    note: str = ""
    bound: float = 0.0

    @staticmethod
    def of(name: str, exact: float, values, note: str = "", bound: float = 0.0) -> "Value":
        """From the values of the runs, (runs,)."""
        values = np.asarray(values, float)
        error = values.std(ddof=1) / np.sqrt(len(values))
        return Value(name, float(exact), float(values.mean()), float(error), len(values), note, bound)

    @property
    def t(self) -> float:
        """Standard errors that the difference is off by beyond the bound."""
        difference = self.measured - self.exact
        beyond = np.sign(difference) * max(abs(difference) - self.bound - 1e-12 * abs(self.exact), 0.0)
        return float(beyond / self.error) if beyond else 0.0

    @property
    def p(self) -> float:
        """Two-sided, Student."""
        from scipy.stats import t

        return float(2 * t.sf(abs(self.t), self.runs - 1))


def together(p_values) -> float:
    """P-value of independent p-values together: the sum of squares of the normal deviates that have them."""
    from scipy.stats import chi2, norm

    deviates = norm.isf(np.maximum(np.asarray(p_values), 1e-300) / 2)
    return float(chi2.sf((deviates**2).sum(), len(deviates)))


@dataclass(frozen=True)
class Patchwise:
    """Patches of a scene, ours against a referee's, or an exact answer.

    Attributes:
        name: scene and method.
        count: patches x bands compared.
        chi_square: per patch and band, with the variances that both sides state.
        expected: the same, as the scatter between runs makes it where nothing but noise differs: about 1 where stated errors are
            true.
        p: of chi-square, by flipping signs.
        worst: largest difference of a patch and band in stated standard errors, and its p-value (Student, with the degrees of
            freedom of the runs alone) times the number of them, at most 1.
        mean: relative difference of the mean over the area, largest of the bands, and its standard error.
        rms: area-weighted RMS of the difference over that of the value; and what both sides' noise gives.
        allowed: RMS that was added to the errors for the size of patches and for rounding, relative.
        discrete: of patches' sizes something was added; then single patches are not judged, since it is known of surfaces only.
    """

    name: str
    count: int
    chi_square: float
    expected: float
    p: float
    worst: tuple[float, float]
    mean: tuple[float, float]
    rms: tuple[float, float]
    allowed: float = 0.0
    discrete: bool = False

    @property
    def agrees(self) -> bool:
        return self.p > ALPHA and (self.discrete or self.worst[1] > ALPHA)


def patchwise(
    name: str,
    runs: Runs,
    theirs: np.ndarray,
    *,
    discretisation: np.ndarray | None = None,
    rows: np.ndarray | None = None,
    seed: int = 1,
) -> Patchwise:
    """Compare irradiance of patches.

    Args:
        theirs: (runs, n_patches, n_bands), as many independent estimates as there are runs; or (n_patches, n_bands), exact.
        discretisation: (n_patches, n_bands), estimated error of our mean that is no noise. What the books' rounding leaves out is
            added to it.
        rows: (n_patches,) bool, to compare these alone.
    """
    from scipy.stats import t as student

    count, area = len(runs.irradiance), runs.patches.area
    noise = theirs.var(axis=0, ddof=1) / count if theirs.ndim == 3 else np.zeros(theirs.shape)
    level = theirs.mean(axis=0) if theirs.ndim == 3 else theirs
    variance = (runs.stated**2).sum(axis=0) / count**2 + noise
    extra = runs.rounding * level if discretisation is None else np.hypot(runs.rounding * level, discretisation)
    difference = runs.irradiance - theirs
    mean = difference.mean(axis=0)
    known = variance > 0
    if np.abs(mean[~known]).max(initial=0) > 1e-6 * level.max():
        raise ValueError(f"{name}: patches without stated errors differ")
    if rows is not None:
        known &= rows[:, None]
    whole, values = (variance + extra**2)[known], difference[:, known]
    chi_square = float((mean[known] ** 2 / whole).mean())
    flipped = _flipped(values, extra[known], whole, seed)
    worst = float((np.abs(mean[known]) / np.sqrt(whole)).max())
    shifts = np.einsum("rpb,p->rb", difference, area) / (area @ level)
    band = int(np.argmax(np.abs(shifts.mean(axis=0))))
    scale = np.sqrt(area @ level**2)

    def relative(square: np.ndarray) -> float:
        return float((np.sqrt(area @ square) / scale).max())

    return Patchwise(
        name,
        int(known.sum()),
        chi_square,
        float(flipped.mean()),
        float((1 + (flipped >= chi_square * (1 - 1e-12)).sum()) / (FLIPS + 1)),
        (worst, float(min(1.0, 2 * student.sf(worst, count - 1) * known.sum()))),
        (float(shifts.mean(axis=0)[band]), float(shifts[:, band].std(ddof=1) / np.sqrt(count))),
        (relative(mean**2), relative(variance)),
        relative(extra**2),
        discretisation is not None,
    )


def _flipped(rows: np.ndarray, extra: np.ndarray, variance: np.ndarray, seed: int) -> np.ndarray:
    """(FLIPS,) chi-square per value of runs (runs, k) with random signs, and of what is no noise as if it were normal."""
    generator, runs, step = np.random.Generator(np.random.Philox(seed)), len(rows), 500
    found = []
    for _ in range(FLIPS // step):
        mean = generator.choice([-1.0, 1.0], (step, runs)) @ rows / runs
        if extra.any():
            mean += extra * generator.normal(size=mean.shape)
        found.append((mean**2 / variance).mean(axis=1))
    return np.concatenate(found)
