"""`bake_lightmap`, which gathers the light at each texel."""

import numpy as np

from ..device.turn import turn
from ..image.denoise import denoised
from ..image.flat import planes
from ..image.gathered import Gathered, lines_of
from ..image.lookup import Lookup
from ..image.output import require_results
from ..image.picture import Picture
from ..image.quantity import choose
from ..run.progress import Listener
from ..scene import Camera
from ..tracing.first_hits import Hits
from . import atlas as atlases
from .model import Lightmap
from .texels import Texels
from .triangles import Triangles

PARTS = 4  # of the lines, which are independent, where errors are asked for or noise is filtered
NOWHERE = Camera((0, 0, 0), (0, 0, 1), (0, 1, 0), 45.0, 1, 1)


def bake_lightmap(
    solution,
    *,
    texels_per_metre: float | None = None,
    size: int | None = None,
    lines: int = 256,
    quantity: str = "radiosity",
    padding: int = 4,
    denoise: bool = False,
    errors: bool = False,
    seed: int = 0,
    progress: Listener | None = None,
) -> Lightmap:
    """Bake a lightmap: give each radiating side a place on a page, and gather the light at each texel there.

    Args:
        solution: what cosine lines read.
        texels_per_metre: density; or
        size: texels along the page, at most; the density is the largest that fits. Default: 1024.
        lines: of each texel, as of a final gather: shadow rays to lamps, and cosine lines that read the solution.
        quantity: "radiosity" (what a surface sends: images and colours are in it) or "irradiance" (what falls on it, to be
            multiplied by reflectances elsewhere); and radiance and luminance.
        padding: texels between charts, 2 or more.
        denoise: filter the noise within planes of surfaces; shadows may lose contrast.
        errors: find standard errors, from four independent parts of the lines.
        seed: equal inputs and an equal seed give equal bits.
        progress: see `solve`.

    Raises:
        OutputError: an option makes no sense, or xatlas is not installed.

    Example:
        >>> solution = rd.solve(rd.subdivide(rd.load_scene("cornell-box"), cells=2), rays=20_000)
        >>> lightmap = rd.bake_lightmap(solution, texels_per_metre=40, lines=16, quantity="irradiance", errors=True)
        >>> bool((lightmap.standard_error >= 0).all()), lightmap.image().shape[2]
        (True, 3)
    """
    require_results(solution)
    parts = PARTS if errors or denoise else 1
    each = lines_of(lines, parts, name="lines", of="a texel", parts="independent parts")
    patches, scene = solution.patches, solution.patches.scene
    shown = choose(solution, quantity)
    page = atlases.make(Triangles.of(scene), density=texels_per_metre, size=size, padding=padding)
    texels = Texels.of(page)
    lookup = Lookup(patches, shown.values, smooth=False)
    patch, place = _patch(lookup, page, texels), texels.place.T
    options = {"lines": each, "points": len(texels) * parts, "seed": seed, "progress": progress}
    look = Gathered.of(solution, lookup, quantity, None, single=False, **options)
    with turn():
        found = np.stack([look.values(patch, *place) for _ in range(parts)])
    mean = found.mean(axis=0)
    spread = found.std(axis=0, ddof=1) / np.sqrt(parts) if parts > 1 else None
    if denoise and spread is not None:
        plane = planes(patches)[patch] * (int(page.chart.max()) + 1) + page.chart[texels.triangle]
        mean = _without_noise(page, texels, mean, spread, plane)
    nearest = _nearest(page, texels)
    covered = np.zeros((page.height, page.width), bool)
    covered[texels.row, texels.column] = True
    facts = {"lines": f"{lines} a texel", "seed": str(seed), "denoised": str(denoise), "padding": str(padding)}
    return Lightmap(
        mean[nearest],
        None if spread is None or not errors else spread[nearest],
        covered,
        covered & shown.own_light[patch][nearest],
        quantity,
        shown.unit,
        shown.bands,
        page.density,
        page,
        texels,
        facts,
    )


def _patch(lookup: Lookup, page: atlases.Atlas, texels: Texels) -> np.ndarray:
    """Return the patch of each texel, (n,)."""
    face, back = page.triangles.face[texels.triangle], page.triangles.back[texels.triangle]
    return lookup.patch(Hits(face, texels.place[:, 0], texels.place[:, 1], ~back, np.zeros(len(texels))))


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
