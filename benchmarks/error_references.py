"""References of ``make bench-error``: long runs of several methods, made once and kept in a folder."""

import os
import re
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
from error_formulas import means_squares, squares, surface_means
from error_processes import Process, Refused
from error_scenes import METHODS, Setting

FOLDER = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "radiosity-bench-error"
SEED = 987_654  # of the first; each method has its own, since one seed means the same numbers
APART, MEANS_APART = 1.25, 5.0  # differences of two methods in their standard errors, above which they disagree: see `apart`


@dataclass(frozen=True)
class Reference:
    """A file that workers read, and what is known of it.

    Attributes:
        variance, means_variance: (n_bands,) squares of its own relative error, of patches and of surface means.
        told: what it is made of, in a line.
        agrees: its methods differ by what their errors allow.
    """

    file: Path
    variance: np.ndarray
    means_variance: np.ndarray
    told: str
    agrees: bool = True

    @property
    def error(self) -> float:
        """Its relative standard error, the largest of the bands."""
        return float(np.sqrt(self.variance.max()))

    @property
    def means_error(self) -> float:
        """The relative standard error of its surface means, the largest of the bands."""
        return float(np.sqrt(self.means_variance.max()))

    def tell(self, equation: str) -> None:
        """Print a line."""
        errors = f"error {self.error:.3%}, of surface means {self.means_error:.3%}"
        print(f"  reference of the {equation} equation: {errors} ({self.told})", flush=True)


def reference(name: str, setting: Setting, equation: str, size: dict, folder: Path, share: float = 1.0) -> Reference:
    """Make what is missing, and put all long runs by an equation together, weighted by the inverse of their variances.

    Args:
        size: what a worker told of the patches.
        share: share of the usual number of lines.
    """
    own = folder / f"{name}-{size['digest']}"
    own.mkdir(parents=True, exist_ok=True)
    if setting.exact:
        return _exact(own, size)
    methods, lines = METHODS[equation], getattr(setting, equation)
    for number, (method, usual) in enumerate(zip(methods, lines, strict=bool(lines))):
        if max(_largest(own, method)[0], 0) < share * usual:
            _make(name, method, share * usual, SEED + number, own, size)
    found = {method: file for method in methods if (file := _largest(own, method)[1])}
    if not found:
        raise Refused(f"there is no reference of the {equation} equation")
    return _together(own / f"{equation}.npz", found)


def _make(name: str, method: str, rays: float, seed: int, own: Path, size: dict) -> None:
    try:
        with Process(name, method) as process:
            if not same(process.ask("describe"), size):
                raise Refused("its patches are others")
            told = process.ask("keep", rays=rays, seed=seed, file=str(own / f"{_slug(method)}-{rays:.0f}.npz"))
    except Refused as reason:
        print(f"  no reference by {method}: {str(reason).partition(';')[0]}", flush=True)
    else:
        print(
            f"  reference by {method}: {told['rays']:,} lines, error {told['error']:.3%}, {told['cpu']:.0f} s of CPU", flush=True
        )


def same(one: dict, two: dict) -> bool:
    """Whether two workers cut the scene alike."""
    return one["digest"] == two["digest"]


def _slug(method: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", method)


def _largest(own: Path, method: str) -> tuple[int, Path | None]:
    """Lines and file of the longest run by a method."""
    found = [(int(file.stem.rpartition("-")[2]), file) for file in own.glob(f"{_slug(method)}-*.npz") if file.stem[-1].isdigit()]
    return max(found, default=(-1, None))


def _exact(own: Path, size: dict) -> Reference:
    """A closed furnace: irradiance is 1."""
    file, none = own / "exact.npz", np.zeros(size["bands"])
    np.savez(file, irradiance=np.ones((size["patches"], size["bands"])))
    return Reference(file, none, none, "exact")


def _together(file: Path, found: dict[str, Path]) -> Reference:
    runs = [dict(np.load(file)) for file in found.values()]
    weights = np.array([1 / run["variance"].max() for run in runs])
    weights /= weights.sum()
    mean = sum(weight * run["irradiance"] for weight, run in zip(weights, runs, strict=True))
    variance, means_variance = (
        np.sum([weight**2 * run[key] for weight, run in zip(weights, runs, strict=True)], axis=0)
        for key in ("variance", "means_variance")
    )
    np.savez(file, irradiance=mean)
    told, agrees = [f"{method} {np.sqrt(run['variance'].max()):.3%}" for method, run in zip(found, runs, strict=True)], True
    for (name, one), (other, two) in combinations(zip(found, runs, strict=True), 2):
        patches, means = apart(one, two)
        told.append(f"{name} to {other} {patches:.2f} standard errors, in surface means {means:.2f}")
        agrees &= patches < APART and means < MEANS_APART
    return Reference(file, variance, means_variance, "; ".join(told), agrees)


def apart(one: dict, two: dict) -> tuple[float, float]:
    """RMS differences of two runs in their standard errors, of patches and of surface means: about 1 where both are right."""
    reflectance, area = one["reflectance"], one["area"]
    patches = squares(reflectance, area, two["irradiance"], one["irradiance"]) / (one["variance"] + two["variance"])
    sizes, means = surface_means(reflectance, area, one["surface"], one["irradiance"])
    _, others = surface_means(reflectance, area, one["surface"], two["irradiance"])
    surfaces = means_squares(sizes, others, means) / (one["means_variance"] + two["means_variance"])
    return float(np.sqrt(patches.max())), float(np.sqrt(surfaces.max()))
