"""`render`: a picture of a solution, to look at (PNG) or to measure in (EXR)."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..errors import OutputError, RadiosityWarning, result_kept
from ..run.on_cluster import on_cluster
from . import bitmap, curves, tone
from . import false_color as maps
from .denoise import denoised
from .gathered import Gathered, lines_of
from .look import Look
from .lookup import Lookup
from .output import check_writable, require, require_results
from .picture import checked_samples, choose_camera, first_hits, take
from .projections import View, checked
from .quantity import choose
from .standing import tell_of_nothing

SUFFIXES = (".png", ".exr")


def render(
    solution,
    path=None,
    *,
    camera: View | int | None = None,
    width: int | None = None,
    height: int | None = None,
    exposure: float | None = None,
    scale: float | None = None,
    smooth: bool = True,
    quantity: str = "radiosity",
    band: str | int | None = None,
    false_color: bool = False,
    range: tuple[float, float] | None = None,
    log: bool = False,
    color_map: str = "viridis",
    samples: int = 4,
    final_gather: int | None = None,
    seed: int = 0,
    denoise: bool = False,
    tone_map: str = "clip",
    progress=None,
    cluster=None,
    hits=None,
) -> np.ndarray:
    """Make a picture of a solution. What radiates nothing (absorbing backs, empty space) is black.

    Args:
        solution: the solution to show.
        path: .png or .exr file to write, or None.
        camera: a `Camera`, an `Orthographic` view (`radiosity.plan` makes one from above), a `Panorama`, or the number of one of
            the scene's cameras; default: its first, or a fitted one where it has none.
        width, height: pixels; default: the camera's. One alone keeps its proportions.
        exposure, scale, smooth, quantity, band: see `radiosity.image.look.Look`. The automatic scale takes the 97th
            percentile of the pixels' strongest channel, lamps apart, to a light tone.
        false_color: colours of a map, one for each value, with a legend; several bands are shown by their luminance.
        range, log, color_map: of the false colours; see `radiosity.image.false_color.colour`.
        samples: lines of sight a pixel.
        final_gather: lines a pixel, that find the light at the points that are seen: shadow rays go to lamps, and others read
            the solution. So shadows and images are sharp, whatever the size of patches. ``smooth`` then means nothing. For
            radiosity, irradiance, radiance and luminance.
        denoise: filter the noise of the final gather within surfaces; edges stay sharp.
        tone_map: "clip", or "filmic" or "agx", which roll bright light off; see `radiosity.image.curves`. Of PNG without false
            colours.
        seed, progress, cluster: of the final gather; see `radiosity.solve`.
        hits: ``hits(scene, origins, directions)`` with the result of `radiosity.tracing.first_hits.first_hits`, the default.

    Returns:
        For PNG or no path: (height, width, 3) uint8, sRGB; with false colours the legend makes it wider. For EXR:
        (height, width, n_bands) float32, linear, in the solution's unit.

    Raises:
        OutputError: the file cannot be written, or an option makes no sense.
        SceneError: the camera is not one that can take a picture.
        DeviceError: rays cannot be traced here.
    """
    path = None if path is None else check_writable(path, SUFFIXES)
    linear = path is not None and path.suffix.lower() == ".exr"
    if linear and false_color:
        raise OutputError(f"{path}: EXR holds physical values; write false colours to a .png file")
    if path is not None and not linear:
        require("PIL", f"{path}: writing PNG")
    if curves.checked(tone_map) != "clip" and (linear or false_color):
        raise OutputError("tone_map is of PNG pictures without false colours; leave it out")
    if false_color:
        require("matplotlib", "the legend of false colours")
        maps.check(range, log, color_map)
    tone.chosen_scale(Look(exposure=exposure, scale=scale), lambda: 1.0)  # refuses what makes no sense before a line is traced
    require_results(solution)
    hits, samples = hits or first_hits, checked_samples(samples)
    lines = None if final_gather is None else lines_of(final_gather, samples)
    if denoise and (lines is None or samples < 2):
        raise OutputError("denoise is of a final gather with 2 samples a pixel or more; give final_gather, or leave it out")
    shown = choose(solution, quantity, band, single=false_color)
    view = choose_camera(solution, camera, width, height, hits)
    look: Lookup | Gathered = Lookup(solution.patches, shown.values, smooth, shown.light)
    with on_cluster(None if lines is None else cluster) as client:
        if lines is not None:
            points = checked(view).width * view.height * samples
            of_gather = {"lines": lines, "points": points, "seed": seed, "progress": progress, "cluster": client}
            look = Gathered.of(solution, look, quantity, band, single=false_color, **of_gather)
        picture = take(solution, shown, view, look=look, samples=samples, hits=hits)
    tell_of_nothing(solution.patches.scene, view, picture.cover)
    picture = replace(picture, values=denoised(picture)) if denoise else picture
    facts = {"quantity": shown.title, "unit": shown.unit, "bands": ", ".join(shown.bands), "camera": repr(view)}
    if final_gather is not None:
        facts |= {"final gather": f"{final_gather} lines a pixel", "seed": str(seed), "denoised": str(denoise)}
    if false_color:
        pixels = maps.colour(picture, title=shown.title, unit=shown.unit, limits=range, log=log, color_map=color_map)
    else:
        values = _known(picture.values) * picture.cover[..., None]
        if linear:
            pixels = values.astype(np.float32)
        else:
            scaled = Look(quantity, band, smooth, exposure, scale)
            factor = tone.chosen_scale(scaled, lambda: tone.automatic_scale(picture.counted))
            facts |= {"scale": repr(factor), "colour": curves.WORDS[tone_map]}
            pixels = curves.displayed(values, factor, tone_map)
    if path is not None:
        _save(pixels, path, facts, shown.bands)
    return pixels


def _save(pixels: np.ndarray, path: Path, facts: dict[str, str], bands: tuple[str, ...]) -> None:
    if path.suffix.lower() == ".exr":
        bitmap.write_exr(pixels, path, facts, bands)
    else:
        bitmap.write_png(pixels, path, facts)


def _known(values: np.ndarray) -> np.ndarray:
    unknown = np.isnan(values).any(axis=-1)
    if unknown.any():
        with result_kept():
            warnings.warn(
                f"{int(unknown.sum())} pixels show patches whose value is unknown; they are black (false colours show them grey)",
                RadiosityWarning,
                stacklevel=3,
            )
    return np.where(np.expand_dims(unknown, -1), 0.0, values)
