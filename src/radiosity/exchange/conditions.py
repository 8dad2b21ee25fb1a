"""The conditions of a scene's surfaces: arguments by name, put over what the scene's file says, and checked."""

import math
import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import RadiosityWarning, SceneError, shown
from ..patches.model import Patches
from ..patches.values import of_sides
from ..scene.heat import HOTTEST, MOST_EDGES, SIDES, Heat
from ..scene.named import surfaces_called
from .report import SURROUNDINGS


@dataclass(frozen=True, eq=False)
class Conditions:
    """What is known of all surfaces.

    Attributes:
        temperature: (n_surfaces,) K, NaN where a surface floats.
        flux: (n_surfaces,) W that each floating surface gets from elsewhere, NaN on others.
        isothermal: (n_surfaces,) bool.
        emissivity: (n_bands, n_patches) in (0, 1].
        surroundings: K or None.
        wavelengths: edges between bands, µm.
    """

    temperature: np.ndarray
    flux: np.ndarray
    isothermal: np.ndarray
    emissivity: np.ndarray
    surroundings: float | None
    wavelengths: tuple[float, ...]

    @staticmethod
    def of(
        patches: Patches,
        *,
        temperature: Mapping[str, float] | None = None,
        emissivity=None,
        flux: Mapping[str, float] | None = None,
        adiabatic: Iterable[str] = (),
        isothermal: Iterable[str] = (),
        surroundings: float | None = None,
        wavelengths: Iterable[float] | None = None,
    ) -> "Conditions":
        """Make them from arguments of `radiative_exchange` and what the scene says.

        Raises:
            SceneError: an unknown surface, a value out of range, two conditions of one surface, or none.
        """
        scene = patches.scene
        names, heat = list(scene.names), scene.heat or Heat.none(len(scene.names))
        kelvin, watts = heat.temperature.copy(), heat.flux.copy()
        adiabatic = dict.fromkeys(_list(adiabatic, "adiabatic"), 0.0)
        given: dict[int, tuple[int, str]] = {}
        for what, values in (("temperature", temperature), ("flux", flux), ("adiabatic", adiabatic)):
            for i, (value, rank) in by_name(values, names, what).items():
                before, kind = given.get(i, (-1, ""))
                if before == rank:
                    raise SceneError(f"surface '{names[i]}' has both {kind} and {what}; give one")
                if before > rank:
                    continue
                given[i] = rank, what
                number = _number(value, what, names[i])
                kelvin[i], watts[i] = (number, np.nan) if what == "temperature" else (np.nan, number)
        one = heat.isothermal.copy()
        one[[i for pattern in _list(isothermal, "isothermal") for i in surfaces_called(names, pattern)]] = True
        around = heat.surroundings if surroundings is None else surroundings
        if around is not None:
            around = _number(around, "temperature", None)
            if SURROUNDINGS in names:
                text = f"a surface is called '{SURROUNDINGS}', too"
                text += "; of two rows of that name in a table the last is what is around the scene"
                warnings.warn(text, RadiosityWarning, stacklevel=3)
        edges = _edges(heat.wavelengths if wavelengths is None else wavelengths)
        of_surface: list[Any] = list(heat.emissivity)
        for i, (value, _) in by_name(emissivity, names, "emissivity").items():
            of_surface[i] = value
        used = np.unique(patches.surface)
        lacking = [names[i] for i in used if np.isnan(kelvin[i]) and np.isnan(watts[i])]
        if lacking:
            raise SceneError(f"no temperature, flux or adiabatic is given for {shown(lacking)}; give each of them one")
        if not np.isfinite(kelvin[used]).any() and around is None:
            raise SceneError(
                "no surface has a temperature, and there are no surroundings: all temperatures are unknown; give one"
            )
        table = _emissivities(patches, of_surface, len(edges) + 1)
        return Conditions(kelvin, np.where(np.isnan(kelvin), watts, np.nan), one, table, around, edges)


def _number(value, what: str, name: str | None) -> float:
    """A temperature or flux within its range."""
    where = f"{what} of surface '{name}'" if name is not None else "temperature of the surroundings"
    rule = f"K, from 0 to {HOTTEST:g}" if what == "temperature" else "W, a finite number"
    if isinstance(value, Mapping):
        raise SceneError(
            f"{where} is {value!r}; both sides of a sheet have one; make the sides two surfaces, one behind the other"
        )
    try:
        number = math.nan if isinstance(value, (bool, str)) else float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number) or (what == "temperature" and not 0 <= number <= HOTTEST):
        raise SceneError(f"{where} is {value!r}; it must be in {rule}")
    return number


def _list(given, what: str) -> list[str]:
    """A list of names or patterns."""
    if isinstance(given, (str, bytes, Mapping)) or not np.iterable(given):
        raise SceneError(f"{what} is {given!r}; give a list of names of surfaces")
    return [str(name) for name in given]


def by_name(given, names: list[str], what: str) -> dict[int, tuple[Any, int]]:
    """Values by the number of the surface, and their rank: an exact name, 2, goes before a pattern, and that before "*", 0."""
    if given is None:
        return {}
    if what == "emissivity" and not isinstance(given, Mapping):
        return dict.fromkeys(range(len(names)), (given, 0))
    if not isinstance(given, Mapping):
        raise SceneError(f"{what} is {given!r}; give values by names of surfaces, such as {{'{names[0]}': ...}}")
    found: dict[int, tuple[Any, int]] = {}
    for pattern, value in ((str(key), value) for key, value in given.items()):
        here = surfaces_called(names, pattern)
        if what == "flux" and len(here) > 1:
            raise SceneError(f"flux of '{pattern}' is W of one whole surface; give {shown(names[i] for i in here)} one each")
        for i in here:
            rank = 2 if names[i] == pattern else 0 if pattern == "*" else 1
            before, its_rank = found.get(i, (None, -1))
            if its_rank == rank and not _equal(before, value):
                text = f"is given by two patterns, as {before!r} and {value!r}; give it by its own name"
                raise SceneError(f"{what} of surface '{names[i]}' {text}")
            if its_rank < rank:
                found[i] = value, rank
    return found


def _equal(one, other) -> bool:
    """Return whether two values are the same; each may be a list or an array."""
    return np.array_equal(np.asarray(one, object), np.asarray(other, object))


def _edges(given) -> tuple[float, ...]:
    """Edges between bands."""
    try:
        edges = tuple(float(edge) for edge in given)
    except (TypeError, ValueError):
        edges = (math.nan,)
    if not all(math.isfinite(edge) and edge > 0 for edge in edges) or any(np.diff(edges) <= 0):
        raise SceneError(f"wavelengths are {given!r}; give the edges between bands in micrometres, above 0 and ascending")
    if len(edges) > MOST_EDGES:
        raise SceneError(f"wavelengths are {len(edges):,} edges between bands; {MOST_EDGES} are the most")
    return edges


def _emissivities(patches: Patches, of_surface: list, bands: int) -> np.ndarray:
    """Emissivities of patches, (bands, n_patches)."""
    scene, used = patches.scene, set(np.unique(patches.surface).tolist())
    result = np.full((bands, len(patches)), np.nan)
    assumed, coloured, told = [], [], []
    for i in sorted(used):
        here, name, value = patches.surface == i, scene.names[i], of_surface[i]
        if value is not None:
            for rows, one in of_sides(patches, here, value, "emissivity", name):
                result[:, rows] = _of_bands(one, bands, name)[:, None]
            bare = here & np.isnan(result[0])
            if bare.any():
                side = SIDES[int(patches.is_back[bare][0])]
                raise SceneError(f"emissivity of surface '{name}' is {value!r}; give one for its {side}, too")
        elif name in scene.assumed:
            assumed.append(name)
        elif bands > 1 or (patches.reflectance[here] != patches.reflectance[here][:, :1]).any():
            coloured.append(name)
        else:
            told.append(name)
            result[0, here] = 1 - patches.reflectance[here, 0] - patches.transmittance[here]
    if assumed:
        raise SceneError(f"no emissivity is given for {shown(assumed)}, and no file gives a reflectance; give emissivity")
    if coloured:
        raise SceneError(
            f"no emissivity is given for {shown(coloured)}; colours of visible light do not tell that of heat in "
            f"{'bands' if bands > 1 else 'one band'}: give emissivity"
        )
    if told:
        rest = " - transmittance" if scene.panes.any() else ""
        text = f"no emissivity is given for {shown(told)}; 1 - reflectance{rest} is taken"
        warnings.warn(text, RadiosityWarning, stacklevel=4)
    return result


def _of_bands(value, bands: int, name: str) -> np.ndarray:
    """The emissivities of a surface in all bands, (bands,)."""
    try:
        values = np.full(1, math.nan) if isinstance(value, (bool, str)) else np.atleast_1d(np.array(value, float))
    except (TypeError, ValueError):
        values = np.full(1, math.nan)
    if values.ndim != 1 or len(values) not in (1, bands):
        raise SceneError(f"emissivity of surface '{name}' is {value!r}; give one number, or one for each of {bands} bands")
    if not ((values > 0) & (values <= 1)).all():
        raise SceneError(f"emissivity of surface '{name}' is {value!r}; it must be above 0, and 1 at most")
    return np.broadcast_to(values, (bands,))
