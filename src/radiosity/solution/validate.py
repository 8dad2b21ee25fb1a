"""The check of a solution file: its arrays must fit together in shapes, kinds, indices and ranges.

The values of results are not checked: whether they were measured cannot be seen from them.
"""

import math

import numpy as np

from ..patches.bases import BASES
from ..patches.model import Patches
from ..scene import panes
from ..scene.lights.given import fault_of, light_bands
from ..scene.model import Back, Scene
from ..scene.paint import Paint
from .books import Books
from .model import Solution

LARGEST = 1e18  # largest coordinate in metres, as in `Scene.from_arrays`
MOST, MOST_OF_PAINTS = 1e60, 1e30  # largest values of other quantities: squares of powers are finite


def validate(solution: Solution) -> None:
    """Refuse a solution whose parts do not fit together.

    Raises:
        ValueError: what does not fit.
    """
    scene, bands = solution.patches.scene, solution.patches.scene.n_bands
    n_patches = len(solution.irradiance) if solution.irradiance.ndim else -1
    validate_patches(solution.patches, n_patches)
    _array("irradiance", solution.irradiance, "f", (n_patches, bands))
    none_yet = solution.quanta == 0 and np.isnan(solution.irradiance).all()  # the run was stopped within its first stage
    _that(none_yet or (np.abs(solution.irradiance) <= MOST).all(), "irradiance that is not finite")
    _array("errors", solution.irradiance_standard_error, "f", (n_patches, bands))
    error = solution.irradiance_standard_error
    _that((np.isnan(error) | ((error >= 0) & (error <= MOST))).all(), "errors out of range")
    _array("arrivals", solution.arrivals, "iu", (n_patches,))
    _that((solution.arrivals >= 0).all() and solution.arrivals.sum(dtype=float) < 2**63, "arrivals out of range")
    _scalars(solution, bands)
    for power, many in ((solution.surface_power, 1), (solution.side_power, 2)):
        if power is not None:
            _array("powers", power, "f", (2, solution.replicates, many * len(scene.names), bands))
            _that((np.abs(power) <= MOST).all(), "powers that are not finite")
    if (bias := solution.side_bias) is not None:
        _array("biases", bias, "f", (2 * len(scene.names), bands))
        _that(((bias >= 0) & (bias <= MOST)).all(), "biases out of range")
    _coefficients(solution, (n_patches, bands), bool(none_yet))
    history = solution.history
    _that(history.ndim == 2 and history.shape[1] == 2 and history.dtype.kind in "fiu", "a history of another shape")


def _coefficients(solution: Solution, shape: tuple[int, int], none_yet: bool) -> None:
    """Refuse coefficients that are not those of the basis of the run's choices."""
    choices = solution.provenance.get("choices")
    basis = BASES.get(choices.get("basis", "constant") if isinstance(choices, dict) else "constant")
    _that(basis is not None, "a basis of no known name")
    if basis is None or basis.size == 1 or none_yet:
        _that(solution.irradiance_coefficients is None or none_yet, "coefficients without a basis")
        return
    mean, error = solution.irradiance_coefficients, solution.irradiance_coefficients_standard_error
    _that(mean is not None and error is not None, "no coefficients of its basis")
    if mean is not None and error is not None:
        for name, value in (("coefficients", mean), ("errors of coefficients", error)):
            _array(name, value, "f", (*shape, basis.size - 1))
        _that((np.abs(mean) <= MOST).all(), "coefficients that are not finite")
        _that((np.isnan(error) | ((error >= 0) & (error <= MOST))).all(), "errors of coefficients out of range")


def validate_patches(patches: Patches, n_patches: int) -> None:
    """Refuse patches of a file whose arrays do not fit together, or that are not so many.

    Raises:
        ValueError: what does not fit.
    """
    scene = patches.scene
    _scene(scene)
    for name, cells in (("columns", patches.columns), ("rows", patches.rows)):
        _array(name, cells, "iu", (scene.n_faces,))
        _that((cells >= 1).all(), f"{name} below 1")
    _that((patches.columns == patches.rows)[~scene.is_quad].all(), "triangles cut unevenly")
    # in floating point, where products cannot overflow; a number of patches that is not the results' is never allocated
    count = patches.columns.astype(float) * patches.rows * np.where(scene.back == Back.RADIATES, 2, 1)
    _that(count.sum() == n_patches, f"{n_patches} results for {count.sum():.0f} patches")
    for name, most in (("own_reflectance", 1), ("own_emission", MOST)):
        own = getattr(patches, name)
        if own is not None:
            _array(name, own, "f", (n_patches, scene.n_bands))
            _that(((own >= 0) & (own < most)).all(), f"{name} out of range")


def _scene(scene: Scene) -> None:
    _that(scene.vertices.ndim == 2 and scene.faces.ndim == 2 and scene.reflectance.ndim == 2, "arrays of other dimensions")
    n, n_vertices, bands = len(scene.faces), len(scene.vertices), scene.n_bands
    _array("vertices", scene.vertices, "f", (n_vertices, 3))
    _array("faces", scene.faces, "i", (n, 4))
    _that(n > 0, "no faces")
    _that(((scene.faces >= (0, 0, 0, -1)) & (scene.faces < n_vertices)).all(), "faces of vertices that there are not")
    _that((np.abs(scene.vertices[scene.faces]) <= LARGEST).all(), "vertices that are not finite")
    _that((scene.area > 0).all(), "faces without area")
    _array("back", scene.back, "u", (n,))
    _that((scene.back <= max(Back)).all(), "backs of no known kind")
    _array("surface", scene.surface, "i", (n,))
    _that(((scene.surface >= 0) & (scene.surface < len(scene.names))).all(), "surfaces without a name")
    for name in ("reflectance", "back_reflectance", "emission", "back_emission"):
        value = getattr(scene, name)
        _array(name, value, "f", (n, bands))
        most = 1 if "reflectance" in name else MOST
        _that(((value >= 0) & (value < most)).all(), f"{name} out of range")
    fault = fault_of(scene.lights)
    _that(not fault, fault)
    _that(all(light_bands(light) == bands for light in scene.lights.all), "lights of other bands")
    if scene.transmittance is not None:
        _array("transmittance", scene.transmittance, "f", (n,))
        _that(((scene.transmittance >= 0) & (scene.transmittance < 1)).all(), "transmittance out of range")
    if scene.diffuse_transmittance is not None:
        _array("diffuse_transmittance", scene.diffuse_transmittance, "f", (n, bands))
        sides, of_surface = (scene.reflectance, scene.back_reflectance), (scene.surface, scene.names, scene.source)
        panes.check(scene.transmittance, scene.back, sides, *of_surface, scene.diffuse_transmittance)
    if scene.cut is not None:
        _that(isinstance(scene.cut.whole, str), "a cut of no scene")
        for name, value in (("cut_face", scene.cut.face), ("cut_region", scene.cut.region)):
            _array(name, value, "i", (n,))
            _that((value >= 0).all(), f"{name} out of range")
    if scene.refractive_index is not None:
        index = scene.refractive_index
        _array("refractive_index", index, "f", (n,))
        glass = (index > 1) & (index <= panes.HIGHEST) & (scene.transmittance is not None)
        _that(((index == 0) | glass).all(), "refractive_index out of range")
    for paint in (scene.reflectance_paint, scene.emission_paint):
        if paint is not None:
            _paint(paint, n, bands)
    for what, names, count in (("surface", scene.names, len(scene.patch_size)), ("band", scene.bands, bands)):
        _that(len(names) == count and all(isinstance(name, str) for name in names), f"other than {count} {what} names")
    _array("patch_size", scene.patch_size, "f", (len(scene.names),))
    _that(isinstance(scene.photometric, bool) and isinstance(scene.source, str), "units or source of another kind")
    _number("scale", scene.scale, above=0)
    for camera in scene.cameras:
        for vector in (camera.origin, camera.target, camera.up):
            _that(len(vector) == 3 and all(map(_is_number, vector)), "a camera without three coordinates")
        _number("field of view", camera.fov, above=0)
        _that(all(type(edge) is int and edge > 0 for edge in (camera.width, camera.height)), "a camera without a size")


def _paint(paint: Paint, n: int, bands: int) -> None:
    _that(len(paint.samplers) in (0, len(paint.images)), "samplers of other images")
    for image in paint.images:
        _that(image.ndim == 3 and image.dtype.kind == "f" and image.size > 0, "an image of another shape")
        _that(image.shape[2] in (1, bands) and bool(((image >= 0) & (image < MOST_OF_PAINTS)).all()), "an image out of range")
    _array("image", paint.image, "i", (n,))
    _that(((paint.image >= -1) & (paint.image < len(paint.images))).all(), "images that there are not")
    _array("uv", paint.uv, "f", (n, 4, 2))
    _that(np.isfinite(paint.uv[paint.image >= 0]).all(), "texture coordinates that are not finite")
    _that(paint.color.ndim == 3 and paint.color.shape[2] in (1, bands), "colours of another shape")
    _array("color", paint.color, "f", (n, 4, paint.color.shape[2]))
    _that(((paint.color >= 0) & (paint.color < MOST_OF_PAINTS)).all(), "colours out of range")
    _that(_is_number(paint.limit, finite=False) and paint.limit > 0, "a paint without a limit")


def _scalars(solution: Solution, bands: int) -> None:
    for name, least in (("rays", 0), ("quanta", 0), ("replicates", 1)):
        value = getattr(solution, name)
        _that(type(value) is int and least <= value < 2**63, f"{name} that is no whole number from {least}")
    _number("seconds", solution.seconds, least=0)
    _that(isinstance(solution.status, str), "a status that is no text")
    _that(all(isinstance(one, str) for one in solution.warnings), "warnings that are no texts")
    known = isinstance(solution.provenance, dict) and {"method", "seed"} <= set(solution.provenance)
    _that(known, "no word of method and seed")
    _that(len(solution.books) == bands, f"{len(solution.books)} books for {bands} bands")
    for book in solution.books:
        _that(isinstance(book, dict) and {*Books.COLUMNS, "closes"} <= set(book), "books without a column")
        _that(all(_is_number(book[name], finite=False) for name in Books.COLUMNS), "books that are no numbers")
        _that(book["closes"] is None or isinstance(book["closes"], bool), "books that close or not in another way")


def _array(name: str, value: np.ndarray, kinds: str, shape: tuple[int, ...]) -> None:
    _that(value.dtype.kind in kinds and value.shape == shape, f"{name} of {value.dtype} and shape {value.shape}, not {shape}")


def _number(name: str, value, *, above: float = -math.inf, least: float = -math.inf) -> None:
    _that(_is_number(value) and value > above and value >= least, f"{name} {value!r}")


def _is_number(value, *, finite: bool = True) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and (not finite or math.isfinite(value))


def _that(holds, otherwise: str) -> None:
    if not holds:
        raise ValueError(otherwise)
