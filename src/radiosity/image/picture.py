"""Pictures of a solution by a camera, in physical units."""

from dataclasses import dataclass, replace

import numpy as np

from ..errors import OutputError
from ..scene import Back, Camera
from . import tone
from .edges import AT_EDGES, rough
from .fit import fitted
from .flat import planes
from .gathered import Gathered
from .lookup import Lookup
from .projections import View, checked, lines_of_sight, resized
from .quantity import Quantity
from .through import Sight

CHUNK = 1 << 19  # lines of sight at once
DARK = 0.5  # share of a pixel's samples that must see a patch for the pixel to count in scales


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture in physical units.

    Attributes:
        values: (height, width, n) float64, mean of the samples that see a patch; NaN where that patch is unknown or would show
            the 0 of a patch that no line met (`Quantity.unmet`), 0 where none is seen.
        cover: (height, width) share of the samples that see a patch; the rest see nothing, or an absorbing back.
        own_light: (height, width) bool, pixels on surfaces that emit.
        variance: (height, width, n) of the mean of a pixel's samples, as if they were independent; NaN with one sample.
        flat: (height, width) number of the plane of a surface where all samples see the same one; -1 elsewhere.
        camera: the camera that took it.
    """

    values: np.ndarray
    cover: np.ndarray
    own_light: np.ndarray
    variance: np.ndarray
    flat: np.ndarray
    camera: View

    @property
    def counted(self) -> np.ndarray:
        """Return the values that decide scales, (m, n): of pixels on patches, without lamps unless there is nothing else."""
        on = self.cover > DARK
        return self.values[on & ~self.own_light] if (on & ~self.own_light).any() else self.values[on]


def take(solution, shown: Quantity, camera: View, *, look: Lookup | Gathered | None = None, samples=4, hits=None) -> Picture:
    """Take a picture with ``samples`` lines of sight a pixel, at the points of a Hammersley set (each row and column once).

    With a final gather, pixels on edges of very unlike brightness get `AT_EDGES`, see `radiosity.image.edges`.

    Args:
        look: finds values from hits; by default those that are shown, smoothed.
    """
    samples = checked_samples(samples)
    hits, camera = hits or first_hits, checked(camera)
    look = look or Lookup(solution.patches, shown.values, light=shown.light)
    sight = Sight(solution.patches.scene, look, hits, shown.adds)
    width, n = int(camera.width), int(camera.width) * int(camera.height)
    unmet = None if isinstance(look, Gathered) or shown.unmet is None else np.append(shown.unmet, False)
    unknown = np.zeros(n, bool)
    total, count, own = np.zeros((n, shown.values.shape[1])), np.zeros(n), np.zeros(n, bool)
    variance, flat, plane = np.full(total.shape, np.nan), np.full(n, -1), np.append(planes(solution.patches), -1)

    def sample(pixels: np.ndarray, each: int) -> None:
        offsets = np.stack([(np.arange(each) + 0.5) / each, _bits_reversed(each)], axis=1)
        step = max(1, CHUNK // each)
        for begin in range(0, len(pixels), step):
            pixel = pixels[begin : begin + step]
            x, y = (pixel % width)[:, None] + offsets[:, 0], (pixel // width)[:, None] + offsets[:, 1]
            values, patch, lamps = sight(*lines_of_sight(camera, x.ravel(), y.ravel()), shown.own_light)
            values, seen = values.reshape(len(pixel), each, -1), plane[patch].reshape(len(pixel), each)
            total[pixel] = values.sum(axis=1) * (samples / each)
            count[pixel] = (seen >= 0).sum(axis=1) * (samples / each)
            if each > 1:
                variance[pixel] = values.var(axis=1, ddof=1) / each
            flat[pixel] = np.where((seen == seen[:, :1]).all(axis=1), seen[:, 0], -1)
            own[pixel] |= lamps.reshape(len(pixel), each).any(axis=1)
            if unmet is not None:
                unknown[pixel] |= unmet[patch].reshape(len(pixel), each).any(axis=1)

    sample(np.arange(n), samples)
    if isinstance(look, Gathered) and 1 < samples < AT_EDGES:
        sample(rough(variance.max(axis=1), flat, total.mean(axis=1) / samples, width), AT_EDGES)
    shape = (int(camera.height), width)
    values = total / np.where(count > 0, count, 1)[:, None]
    values[unknown & (total == 0).all(axis=1)] = np.nan
    return Picture(
        values.reshape(*shape, -1),
        (count / samples).reshape(shape),
        own.reshape(shape),
        variance.reshape(*shape, -1),
        flat.reshape(shape),
        camera,
    )


def checked_samples(samples) -> int:
    """Return the number of lines of sight a pixel.

    Raises:
        OutputError: it is no number of them.
    """
    if isinstance(samples, bool) or int(samples) != samples or not 1 <= samples <= 1024:
        raise OutputError(f"samples is {samples}; it must be a whole number from 1 to 1024")
    return int(samples)


def choose_camera(solution, camera: View | int | None, width, height, hits) -> View:
    """Return the camera asked for (a view, or the number of one of the scene's), the scene's first, or a fitted one."""
    cameras = solution.patches.scene.cameras
    for name, value in (("width", width), ("height", height)):
        if value is not None and not (np.isfinite(value) and int(value) == value >= 1):
            raise OutputError(f"{name} is {value}; it must be a whole number of 1 or more, in pixels")
    if isinstance(camera, View):
        chosen = camera
    elif camera is None and not cameras:
        light = tone.luminance(np.asarray(solution.radiosity, np.float64))
        usual = resized(Camera((0, 0, 0), (0, 0, 1)), width, height)  # one side alone keeps its proportions
        return fitted(solution.patches, light, hits, width=usual.width, height=usual.height)
    else:
        number = 0 if camera is None else camera
        if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(cameras):
            raise OutputError(f"camera {camera!r} does not exist; the scene has {len(cameras)} (counted from 0)")
        chosen = cameras[number]
    return resized(chosen, width, height)


def first_hits(scene, origins, directions):
    """Trace first hits; imported when a picture is taken, since it starts a back end. Open lamps are seen from their front."""
    from ..tracing import first_hits

    seen = replace(scene, back=np.where(scene.back == Back.OPEN, Back.PASSES, scene.back).astype(np.uint8))
    return first_hits.first_hits(seen if (scene.back == Back.OPEN).any() else scene, origins, directions)


def _bits_reversed(n: int) -> np.ndarray:
    """Return radical inverses to base 2 of 0 to n - 1, moved to the middle of their cells."""
    k, result, place = np.arange(n), np.full(n, 0.5 / 2 ** max(n - 1, 0).bit_length()), 0.5
    while k.any():
        result += place * (k & 1)
        k, place = k >> 1, place / 2
    return result
