"""The unified glare rating of observers (CIE 117, 1995)."""

from dataclasses import dataclass
from functools import cached_property
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..device.memory import limited
from ..device.turn import turn
from ..errors import MethodError, printable, shown
from ..patches.model import Patches
from ..run.budget import Budget
from ..run.on_cluster import on_cluster
from ..run.progress import Listener
from ..run.whole_number import whole
from ..scene.habits import warn
from ..scene.model import Scene
from ..scene.up import up_vector
from ..solution.model import Solution
from .glare_sources import Seen, photopic_of, refuse
from .guth import position_index
from .measure import scene_of
from .model import Sensors
from .run import traced
from .target import half_width

LARGE, SMALL = 0.1, 3e-4  # sr: beyond them the formula was not made for a source (CIE 117)


@dataclass(frozen=True, eq=False)
class GlareRating:
    """Ratings of observers: from 10, where nobody is disturbed, to 30.

    Attributes:
        observers: points, and the lines of sight.
        values: (replicates, n) float64; -inf where no source is in view.
        background: (replicates, n) cd/m², what the eye receives from reflecting surfaces, over pi.
        sources: for each observer a row for each source in view: name, luminance, solid angle, position index, and share of the
            sum in the formula.

    Example:
        >>> room = rd.load_scene("room")
        >>> from dataclasses import replace
        >>> lit = replace(room, photometric=True, emission=500 * room.emission)
        >>> found = rd.unified_glare_rating(rd.subdivide(lit, cells=4), [0.5, 2, 1.2], [1, 0, 0], rays=400_000)
        >>> low, high = found.interval()
        >>> bool(low[0] < found.ugr[0] < high[0]), found.sources[0][0]["name"]
        (True, 'light')
    """

    observers: Sensors
    values: np.ndarray
    background: np.ndarray
    sources: tuple[tuple[dict, ...], ...]

    @cached_property
    def ugr(self) -> np.ndarray:
        """The rating of each observer, (n,)."""
        return self.values.mean(axis=0)

    def interval(self, level: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
        """Return the ends of Student's intervals, (n,) each; NaN with one replicate or without a source."""
        seen = np.isfinite(self.ugr)
        width = np.where(seen, half_width(np.where(seen, self.values, 0.0), level), np.nan)
        return self.ugr - width, self.ugr + width

    def report(self) -> str:
        """Return a line for each observer."""
        lines = ["unified glare rating (CIE 117): 16, 19, 22 and 25 are limits of EN 12464-1"]
        low, high = self.interval()
        for i, (point, gaze) in enumerate(zip(self.observers.points, self.observers.normals, strict=True)):
            where = f"at {np.round(point, 3).tolist()} towards {np.round(gaze, 3).tolist()}"
            background = f"background {self.background[:, i].mean():.4g} cd/m²"
            if not self.sources[i]:
                lines.append(f"UGR none  {where}: no source in view, {background}")
                continue
            top = sorted(self.sources[i], key=lambda row: -row["share"])[:3]
            most = ", ".join(f"{printable(row['name'])} {row['share']:.0%}" for row in top)
            lines.append(f"UGR {self.ugr[i]:.1f} ± {(high[i] - low[i]) / 2:.1g}  {where}: {background}; most by {most}")
        return "\n".join(lines)


def unified_glare_rating(
    scene: Scene | Patches | Solution,
    observer: ArrayLike,
    direction: ArrayLike,
    *,
    rays: float | None = None,
    error: float | None = None,
    replicates: int | None = None,
    seed: int = 0,
    device: str = "auto",
    progress: Listener | None = None,
    memory: str | float | None = None,
    cluster: Any = None,
) -> GlareRating:
    """Rate the glare of luminaires, and of surfaces that emit, for observers.

    UGR = 8 log10(0.25 / Lb * sum of L² omega / p²): L is the luminance of a source and omega its solid angle, as far as it is
    seen; p is Guth's position index; Lb is the background's luminance, from what surfaces reflect. A surface that emits counts
    patch by patch.

    Args:
        scene: a `Solution`, or a scene or patches to solve first.
        observer: (3,) or (n, 3) m, the eyes.
        direction: (3,) or (n, 3), lines of sight, of any length.
        rays, error: lines in all, or the relative error of the background's luminance; by default an error of 1 %.
        replicates, seed, device, progress, memory, cluster: as of `measure`.

    Returns:
        The ratings, with errors.

    Raises:
        MethodError: the scene is not photometric, has a sky, or a luminaire without luminous size; a gaze straight up or down.

    Example:
        >>> room = rd.load_scene("room")
        >>> from dataclasses import replace
        >>> lit = replace(room, photometric=True, emission=500 * room.emission)
        >>> found = rd.unified_glare_rating(rd.subdivide(lit, cells=4), [0.5, 2, 1.2], [1, 0, 0], rays=400_000)
        >>> found.sources[0][0]["name"], round(float(found.ugr[0]))
        ('light', 22)
    """
    number = whole(seed, "seed", 0)
    observers = Sensors.of(observer, direction, name="observers")
    if rays is not None and error is not None:
        raise MethodError("give rays or an error, not both")
    budget = Budget(rays=rays, error=0.01 if rays is None and error is None else error)
    given = scene_of(scene, "unified_glare_rating")
    refuse(given)
    up = np.array(up_vector(given))
    steep = np.linalg.norm(np.cross(observers.normals, up), axis=1) < 1e-6
    if steep.any():
        raise MethodError(f"observer {int(np.argmax(steep))} looks straight up or down; a position index needs another direction")
    with limited(memory), turn(), on_cluster(cluster) as client:
        settings = (replicates, number, device, progress)
        solution, background = traced(scene, observers, budget, "worst", *settings, direct=False, cluster=client)
        dark = photopic_of(background.values) / np.pi
        sums, rows = zip(
            *(_sum(solution.patches, *one, up, device) for one in zip(observers.points, observers.normals, strict=True)),
            strict=True,
        )
    with np.errstate(divide="ignore"):
        values = 8 * np.log10(0.25 / dark * np.array(sums))
    _tell_of_sizes(rows)
    return GlareRating(observers, values, dark, rows)


def _sum(patches: Patches, point: np.ndarray, gaze: np.ndarray, up: np.ndarray, device: str) -> tuple[float, tuple[dict, ...]]:
    """Return the sum of L² omega / p² over all sources in view, and a row for each of them by name."""
    seen = Seen.of(patches, point, device)
    index = position_index(seen.way, gaze, up)
    parts = seen.luminance**2 * seen.solid_angle / index**2
    whole_sum = float(parts.sum())
    rows = []
    order = sorted(np.flatnonzero(parts > 0).tolist(), key=lambda i: seen.names[i])
    for name, members in groupby(order, key=lambda i: seen.names[i]):
        some = np.array(list(members))
        angle = seen.solid_angle[some]
        rows.append(
            {
                "name": name,
                "luminance": float((seen.luminance[some] * angle).sum() / angle.sum()),
                "solid angle": float(angle.sum()),
                "position index": float(np.sqrt((seen.luminance[some] ** 2 * angle).sum() / parts[some].sum())),
                "share": float(parts[some].sum() / whole_sum),
            }
        )
    return whole_sum, tuple(rows)


def _tell_of_sizes(rows: tuple[tuple[dict, ...], ...]) -> None:
    for word, wrong in (("large", lambda a: a > LARGE), ("small", lambda a: a < SMALL)):
        names = list(dict.fromkeys(row["name"] for one in rows for row in one if wrong(row["solid angle"])))
        if names:
            bound = f"above {LARGE} sr" if word == "large" else f"below {SMALL} sr"
            warn(f"{shown(names)} look {bound}, where UGR was not made for sources so {word} (CIE 117, CIE 147)")
