"""Lights in groups, one after the other: light is linear, so any dimming is a sum of what each group gives."""

from dataclasses import replace
from fnmatch import fnmatchcase

import numpy as np

from ..errors import MethodError, SceneError, shown
from ..patches import Patches
from ..scene.model import Scene

OTHERS = "others"


def parts_of(given: Scene | Patches, groups: dict[str, list[str]]) -> dict[str, Scene | Patches]:
    """Return what is given with the light of one group alone, for each group by name.

    Args:
        groups: names or patterns of each group; empty: see `measure`.

    Raises:
        SceneError: no light is called so, or a light is in two groups.
    """
    scene = given if isinstance(given, Scene) else given.scene
    lit = _emitting(given)
    called = [(scene.names[i],) for i in lit] + [tuple({_group(one): 1, one.name: 1}) for one in scene.lights.all]
    owners = _owners(called, groups, scene.source) if groups else [names[0] for names in called]
    names = list(dict.fromkeys([*groups, *owners])) if groups else list(dict.fromkeys(owners))
    of_lights = owners[len(lit) :]
    return {
        name: only(
            given,
            scene,
            [surface for surface, owner in zip(lit, owners, strict=False) if owner == name],
            [owner == name for owner in of_lights],
        )
        for name in names
    }


def check_levels(levels: dict[str, float], names: list[str]) -> None:
    """Refuse levels of dimming that make no sense.

    Raises:
        MethodError: there is no such group, or a level is negative or no number.
    """
    if unknown := [name for name in levels if name not in names]:
        raise MethodError(f"no group of lights is called {shown(unknown)}; there are {shown(names, 20)}")
    if wrong := [name for name, level in levels.items() if not 0 <= level < np.inf]:
        raise MethodError(f"the level of '{wrong[0]}' is {levels[wrong[0]]}; it must be a number of 0 or more")


def _group(light) -> str:
    return getattr(light, "group", "") or light.name


def _emitting(given: Scene | Patches) -> list[int]:
    """Return the surfaces that emit."""
    if isinstance(given, Patches):
        return np.unique(given.surface[given.emission.any(axis=1)]).tolist()
    return np.unique(given.surface[(given.emission > 0).any(axis=1) | (given.back_emission > 0).any(axis=1)]).tolist()


def _owners(called: list[tuple[str, ...]], groups: dict[str, list[str]], source: str) -> list[str]:
    """Return the group of each light.

    Args:
        called: by which names each light is known.
    """
    lists = {group: [names] if isinstance(names, str) else list(names) for group, names in groups.items()}
    every = list(dict.fromkeys(name for names in called for name in names))
    for group, patterns in lists.items():
        if missing := [one for one in patterns if not any(_matches(name, one) for name in every)]:
            raise SceneError(f"{source}: group '{group}': no light is called {shown(missing)}; there are {shown(every, 20)}")
    owners = []
    for names in called:
        here = [group for group, patterns in lists.items() if any(_matches(name, one) for name in names for one in patterns)]
        if len(here) > 1:
            raise SceneError(f"{source}: light '{names[-1]}' is in the groups {shown(here)}; a light is dimmed by one")
        owners.append(here[0] if here else OTHERS)
    return owners


def _matches(name: str, pattern: str) -> bool:
    return name == pattern or fnmatchcase(name, pattern)


def only(given: Scene | Patches, scene: Scene, surfaces: list[int], kept: list[bool]) -> Scene | Patches:
    """Return what is given with the light of these surfaces and of the lights that are kept."""
    on = np.isin(scene.surface, surfaces)[:, None]
    lights, chosen = scene.lights, {id(one) for one, keep in zip(scene.lights.all, kept, strict=True) if keep}
    alone = replace(
        scene,
        emission=np.where(on, scene.emission, 0.0),
        back_emission=np.where(on, scene.back_emission, 0.0),
        lights=replace(
            lights,
            luminaires=tuple(one for one in lights.luminaires if id(one) in chosen),
            suns=tuple(one for one in lights.suns if id(one) in chosen),
            sky=lights.sky if id(lights.sky) in chosen else None,
        ),
    )
    if isinstance(given, Scene):
        return alone
    own = None if given.own_emission is None else np.where(on[given.face], given.own_emission, 0.0)
    return replace(given, scene=alone, own_emission=own)
