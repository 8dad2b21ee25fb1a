"""What the entries of a .toml scene say about heat (docs/radiative-exchange.md)."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ....errors import SceneError, shown
from ...heat import Heat
from ...parts import Material

ROUNDING = 1e-12  # by which a sum may be above 1


def check_bands(asked, source: str) -> None:
    """Refuse emissivities of another number of bands than the file has.

    Raises:
        SceneError: there are some.
    """
    bands = len(asked.wavelengths) + 1
    for number, entry in enumerate(asked.surface, 1):
        if len(entry.emissivity or [0]) not in (1, bands):
            raise SceneError(
                f"{source}: surface {number} ('{entry.name}'): emissivity has {len(entry.emissivity)} numbers; wavelengths = "
                f"{list(asked.wavelengths)} makes {bands} {'bands' if bands > 1 else 'band'}: give one number, or {bands}"
            )


def heat_of(asked, names: tuple[str, ...], means: Callable[[object, str], bool], source: str, own=None) -> Heat | None:
    """Return the conditions of surfaces, or None where the file says nothing about heat.

    For each surface the last entry that gives a temperature, flux or adiabatic counts, and the last that gives an emissivity.

    Args:
        asked: the file.
        names: of all surfaces.
        means: whether an entry holds for a surface of this name.
        source: the file's name, for messages.
        own: emissivities that the geometry files give, by name.

    Raises:
        SceneError: a flux for several surfaces.
    """
    heat, bands = Heat.none(len(names)), len(asked.wavelengths) + 1
    emissivity = [(own or {}).get(name) for name in names]
    said = asked.surroundings is not None or bands > 1 or any(emissivity)
    for number, entry in enumerate(asked.surface, 1):
        here = [i for i, name in enumerate(names) if means(entry, name)]
        what = f"{source}: surface {number} ('{entry.name}')"
        said |= any(x is not None for x in (entry.temperature, entry.flux, entry.adiabatic, entry.emissivity, entry.isothermal))
        if entry.flux is not None and len(here) > 1:
            raise SceneError(f"{what}: flux is W of one whole surface; give {shown([names[i] for i in here])} an entry each")
        if entry.temperature is not None or entry.flux is not None or entry.adiabatic is not None:
            heat.temperature[here] = np.nan if entry.temperature is None else entry.temperature
            heat.flux[here] = np.nan if entry.temperature is not None else entry.flux or 0.0
        if entry.isothermal is not None:
            heat.isothermal[here] = entry.isothermal
        if entry.emissivity is not None:
            for i in here:
                emissivity[i] = tuple(entry.emissivity)
    whole = replace(heat, emissivity=tuple(emissivity), surroundings=asked.surroundings, wavelengths=tuple(asked.wavelengths))
    return whole if said else None


def reflecting(material: Material, emissivity: list[float] | None, source: str, name: str) -> Material:
    """Return a material that reflects 1 - emissivity, where no file gives a reflectance and the emissivity is one number.

    A pane reflects 1 - emissivity - transmittance.

    Raises:
        SceneError: that is below 0.
    """
    if material.reflectance is not None or emissivity is None or len(emissivity) != 1:
        return material
    rest = 1 - emissivity[0] - material.transmittance - max(material.diffuse_transmittance or (0.0,))
    if rest < -ROUNDING:
        raise SceneError(
            f"{source}: surface '{name}' has emissivity {emissivity[0]:g} and transmittance {material.transmittance:g}, above 1 "
            "together; lower one of them"
        )
    return replace(material, reflectance=(max(rest, 0.0),), back_reflectance=None, diffuse=True, given=True, origin=source)
