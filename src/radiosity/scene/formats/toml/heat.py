"""What the entries of a .toml scene say about heat (docs/radiative-exchange.md)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ....errors import SceneError, shown
from ...heat import SIDES, Emissivity, Heat
from ...parts import Material

ROUNDING = 1e-12  # by which a sum may be above 1


def check_bands(asked, source: str) -> None:
    """Refuse emissivities of another number of bands than the file has.

    Raises:
        SceneError: there are some.
    """
    bands = len(asked.wavelengths) + 1
    for number, entry in enumerate(asked.surface, 1):
        given = entry.emissivity
        for values in given.values() if isinstance(given, dict) else [given or [1.0]]:
            if len(values) not in (1, bands):
                raise SceneError(
                    f"{source}: surface {number} ('{entry.name}'): emissivity has {len(values)} numbers; wavelengths = "
                    f"{list(asked.wavelengths)} makes {bands} {'bands' if bands > 1 else 'band'}: give one number, or {bands}"
                )


def heat_of(asked, names: tuple[str, ...], means: Callable[[object, str], bool], source: str, own=None) -> Heat | None:
    """Return the conditions of surfaces, or None where the file says nothing about heat.

    For each surface the last entry that gives a temperature, flux or adiabatic counts, and of each side the last that gives an
    emissivity.

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
                emissivity[i] = of_sides(emissivity[i], entry.emissivity)
    whole = replace(heat, emissivity=tuple(emissivity), surroundings=asked.surroundings, wavelengths=tuple(asked.wavelengths))
    return whole if said else None


def of_sides(before: Emissivity | None, given: Mapping | Sequence[float] | None) -> Emissivity | None:
    """Return the emissivity of a surface after an entry that gives one, of both sides or of one of them."""
    if given is None:
        return before
    if not isinstance(given, Mapping):
        return tuple(given)
    sides = dict(before) if isinstance(before, dict) else {} if before is None else dict.fromkeys(SIDES, before)
    return sides | {side: tuple(values) for side, values in given.items()}


def reflecting(material: Material, emissivity: Emissivity | None, source: str, name: str) -> Material:
    """Return a material that reflects 1 - emissivity, where no file gives a reflectance and the emissivity is one number a side.

    A pane reflects 1 - emissivity - transmittance.

    Raises:
        SceneError: that is below 0.
    """
    if material.reflectance is not None or emissivity is None:
        return material
    by_side = emissivity if isinstance(emissivity, dict) else {SIDES[0]: emissivity}
    values = tuple(by_side[side] for side in SIDES if side in by_side)
    if any(len(value) != 1 for value in values) or SIDES[0] not in by_side:
        return material
    through = material.transmittance + max(material.diffuse_transmittance or (0.0,))
    rests = [1 - value[0] - through for value in values]
    for rest, value in zip(rests, values, strict=True):
        if rest < -ROUNDING:
            raise SceneError(
                f"{source}: surface '{name}' has emissivity {value[0]:g} and transmittance {material.transmittance:g}, above 1 "
                "together; lower one of them"
            )
    front, *back = ((max(rest, 0.0),) for rest in rests)
    return replace(
        material, reflectance=front, back_reflectance=back[0] if back else None, diffuse=True, given=True, origin=source
    )
