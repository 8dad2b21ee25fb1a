"""`bake_lightmap`, which gathers the light at each texel."""

from typing import Any

import numpy as np

from ..device.turn import turn
from ..image.denoise import denoised
from ..image.flat import planes
from ..image.gathered import Gathered, lines_of
from ..image.lookup import Lookup
from ..image.output import require_results
from ..image.picture import Picture, checked_samples
from ..image.quantity import choose
from ..run.on_cluster import on_cluster
from ..run.progress import Listener
from ..scene import Camera
from ..tracing.first_hits import Hits
from . import atlas as atlases
from .dark import OF_MIDDLES, dark_and_dim, unlit
from .hidden import from_beside, mean_of_seen
from .model import Lightmap
from .texels import Texels, points_of
from .triangles import Triangles

PARTS = 4  # of the lines, which are independent, where errors are asked for or noise is filtered
NOWHERE = Camera((0, 0, 0), (0, 0, 1), (0, 1, 0), 45.0, 1, 1)


def bake_lightmap(
    solution,
    *,
    texels_per_metre: float | None = None,
    size: int | None = None,
    lines: int = 256,
    samples: int = 4,
    quantity: str = "radiosity",
    padding: int = 4,
    denoise: bool = False,
    errors: bool = False,
    seed: int = 0,
    progress: Listener | None = None,
    cluster: Any = None,
) -> Lightmap:
    """Bake a lightmap: give each radiating side a place on a page, and gather the light at each texel there.

    Args:
        solution: what cosine lines read.
        texels_per_metre: density; or
        size: texels along the page, at most; the density is the largest that fits. Default: 1024.
        lines: of each texel, as of a final gather: shadow rays to lamps, and cosine lines that read the solution.
        samples: points spread over each texel, which share its lines, so that edges of shadows are smooth; 1: its middle alone.
        quantity: "radiosity" (what a surface sends: images and colours are in it) or "irradiance" (what falls on it, to be
            multiplied by reflectances elsewhere); and radiance and luminance.
        padding: texels between charts, 2 or more.
        denoise: filter the noise within planes of surfaces; shadows may lose contrast.
        errors: find standard errors, from four independent parts of the lines.
        seed: equal inputs and an equal seed give equal bits.
        progress, cluster: see `solve`.

    Raises:
        OutputError: an option makes no sense, or xatlas is not installed.

    Example:
        >>> solution = rd.solve(rd.subdivide(rd.load_scene("cornell-box"), cells=2), rays=20_000)
        >>> lightmap = rd.bake_lightmap(solution, texels_per_metre=40, lines=64, quantity="irradiance", errors=True)
        >>> bool((lightmap.standard_error >= 0).all()), lightmap.image().shape[2]
        (True, 3)
    """
    require_results(solution)
    parts = PARTS if errors or denoise else 1
    samples = checked_samples(samples)
    each = lines_of(lines, parts * samples, name="lines", of="a texel", parts="samples and independent parts")
    patches, scene = solution.patches, solution.patches.scene
    shown = choose(solution, quantity)
    atlases.check(texels_per_metre, size, padding)
    lookup, candidates = Lookup(patches, shown.values, smooth=False), unlit(solution)
    with turn(), on_cluster(cluster) as client:

        def gathered(lines: float, points: int, seed: int) -> Gathered:
            options = {"lines": lines, "points": points, "seed": seed, "progress": progress, "cluster": client}
            return Gathered.of(solution, lookup, quantity, None, single=False, **options)

        # the page does not depend on the lines and the seed of texels
        dark, dim = dark_and_dim(solution, gathered(OF_MIDDLES, len(candidates), 0), candidates)
        page = atlases.make(Triangles.of(scene, dark, dim), density=texels_per_metre, size=size, padding=padding)
        texels = Texels.of(page)
        places = [texels.place] if samples == 1 else points_of(page, texels, samples)
        patch = [_patch(lookup, page, texels, place) for place in places]
        look = gathered(each, len(texels) * parts * samples, seed)
        drawn = [[look.with_backs(one, *place.T) for one, place in zip(patch, places, strict=True)] for _ in range(parts)]
    found, hidden = mean_of_seen(*(np.array([[one[i] for one in part] for part in drawn]) for i in (0, 1)))
    found[:, page.triangles.dark[texels.triangle]] = 0.0
    mean = found.mean(axis=0)
    spread = found.std(axis=0, ddof=1) / np.sqrt(parts) if parts > 1 else None
    if denoise and spread is not None:
        plane = planes(patches)[patch[0]] * (int(page.chart.max()) + 1) + page.chart[texels.triangle]
        mean = _without_noise(page, texels, mean, spread, plane)
    mean = from_beside(page, texels, hidden, mean)
    spread = None if spread is None else from_beside(page, texels, hidden, spread)
    nearest = _nearest(page, texels)
    covered = np.zeros((page.height, page.width), bool)
    covered[texels.row, texels.column] = True
    facts = {
        "lines": f"{lines} a texel",
        "samples": f"{samples} a texel",
        "seed": str(seed),
        "denoised": str(denoise),
        "padding": str(padding),
    }
    return Lightmap(
        mean[nearest],
        None if spread is None or not errors else spread[nearest],
        covered,
        covered & shown.own_light[patch[0]][nearest],
        quantity,
        shown.unit,
        shown.bands,
        page.density,
        page,
        texels,
        facts,
    )


def _patch(lookup: Lookup, page: atlases.Atlas, texels: Texels, place: np.ndarray) -> np.ndarray:
    """Return the patch of each texel at a point of it, (n,)."""
    face, back = page.triangles.face[texels.triangle], page.triangles.back[texels.triangle]
    return lookup.patch(Hits(face, place[:, 0], place[:, 1], ~back, np.zeros(len(texels))))


def _nearest(page: atlases.Atlas, texels: Texels) -> np.ndarray:
    """Return the number of the texel, of those that stand for points, that is nearest to each, (height, width)."""
    from scipy.ndimage import distance_transform_edt

    number = np.full((page.height, page.width), -1)
    number[texels.row, texels.column] = np.arange(len(texels))
    if (number >= 0).all():
        return number
    row, column = np.asarray(distance_transform_edt(number < 0, return_distances=False, return_indices=True))
    return number[row, column]


def _without_noise(page: atlases.Atlas, texels: Texels, mean, spread, plane) -> np.ndarray:
    """Return values without most of their noise, (n, n_bands)."""
    shape, at = (page.height, page.width), (texels.row, texels.column)
    values, variance = (np.zeros((*shape, mean.shape[1])) for _ in range(2))
    flat = np.full(shape, -1)
    values[at], variance[at], flat[at] = mean, spread**2, plane
    nothing = np.zeros(shape, bool)
    return denoised(Picture(values, nothing.astype(float), nothing, variance, flat, NOWHERE))[at]
