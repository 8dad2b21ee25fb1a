"""A .toml scene: geometry files, and reflectance, emission, sides and patch size by surface name (docs/scene-toml.md)."""

import tomllib
from collections.abc import Set as AbstractSet
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...arguments import LARGEST
from ...assemble import Part, ReadOptions, warn
from ...combine import combine
from ...lights.add import scaled, with_lights
from ...lights.model import Lights
from ...model import Back, Camera, Scene
from ..beside import named_file
from ..units import UNITS
from .daylight import daylight_of
from .heat import check_bands, heat_of, of_sides, reflecting
from .luminaires import luminaires_of, warn_of_y_up
from .panes import check_pane, clear_light
from .sensors import sensors_of
from .upward import upward_of

BACKS = {"absorbs": Back.ABSORBS, "radiates": Back.RADIATES, "passes": Back.PASSES, "open": Back.OPEN}
SIDES = {1: Back.ABSORBS, 2: Back.RADIATES}


def read(path: Path, options: ReadOptions) -> Scene:
    """Read a .toml scene and its geometry.

    Raises:
        SceneError: not TOML, a key or value that is not understood, or geometry that cannot be read.
    """
    from .schema import checked

    try:
        values = tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        hint = "; save it as UTF-8" if isinstance(error, UnicodeDecodeError) else ""
        raise SceneError(f"{path}: is no TOML ({error}){hint}") from None
    asked = checked(values, str(path))
    check_bands(asked, str(path))
    factors = [UNITS[entry.unit or asked.unit] * (entry.scale or asked.scale) for entry in asked.geometry]

    def dressed(looks: Looks) -> list[Scene]:
        each = zip(asked.geometry, factors, strict=True)
        return [_geometry(entry.file, factor, entry.name, looks, options, path) for entry, factor in each]

    looks = Looks(asked.surface, str(path))
    scenes = dressed(looks)
    names = [name for scene in scenes for name in scene.names]
    called = {surface.name for surface in asked.surface} & set(names)
    if any(name != one and _matches(name, one) for one in called for name in names):
        looks = Looks(asked.surface, str(path), called)  # known only now: lamp[1] is a surface here, and lamp1 another one
        scenes = dressed(looks)
    several = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    if several:
        text = "surfaces of the same name in several geometry files become one; tell them apart by a name = of each [[geometry]]"
        warn(f"{path}: {text}: {shown(several)}")
    for surface in asked.surface:
        if not any(_matches(name, surface.name) for name in names):
            warn(f"{path}: no surface is called '{surface.name}'; there are {shown(sorted(set(names)), 20)}")
    same = len(set(factors)) == 1 and len({scene.scale for scene in scenes}) == 1
    photometric = _photometric(asked.photometric, scenes, path)
    scene = combine(scenes, source=str(path), photometric=photometric, scale=factors[0] * scenes[0].scale if same else 1.0)
    cameras = tuple(
        Camera(_times(c.origin, 1), _times(c.target, 1), _times(c.up, 1), c.fov, c.width, c.height) for c in asked.camera
    )
    for number, camera in enumerate(cameras, 1):
        gaze = np.subtract(camera.target, camera.origin)
        if not np.linalg.norm(np.cross(gaze, camera.up)) > 1e-9 * np.linalg.norm(gaze) * np.linalg.norm(camera.up):
            raise SceneError(f"{path}: camera {number} looks along its up vector, or nowhere; move target or turn up")
    own = {name: e for one in scenes if one.heat for name, e in zip(one.names, one.heat.emissivity, strict=True)}
    heat = heat_of(asked, scene.names, looks.means, str(path), own)
    scene = looks.with_powers(replace(scene, cameras=cameras + scene.cameras, heat=heat), str(path))
    factor, up = UNITS[asked.unit] * asked.scale, upward_of(asked, scene, path)
    scene = replace(scene, sensors=sensors_of(asked.sensors, factor, scene, options, path, up))
    luminaires = luminaires_of(asked.luminaire, factor, options, path, up)
    warn_of_y_up(asked.luminaire, up, path)
    lights = daylight_of(asked, scene, factor, options, path, up)
    return _lit(scene, replace(lights, luminaires=tuple(luminaires)), asked.photometric, path)


def _lit(scene: Scene, lights: Lights, photometric: bool | None, path: Path) -> Scene:
    """Return the scene with the lights of the file itself.

    Raises:
        SceneError: some light of the scene is in W and other light in lm, or not in the unit that the file says.
    """
    if not lights and not scene.lights:  # openings alone light nothing
        return scene
    lit = with_lights(scene, lights)
    if photometric is not None and lit.photometric != photometric:
        what = f"photometric is {str(photometric).lower()}, and light '{lit.lights.all[-1].name}' is in"
        raise SceneError(f"{path}: {what} {'lm' if lit.photometric else 'W'}; leave the key out")
    return lit


class Looks:
    """The surface entries of a file: for every property of a surface the last entry that matches and gives it.

    Attributes:
        entries: as the file has them.
        source: the file.
        called: names of surfaces; an entry of such a name means that surface alone, whatever else it matches as a pattern.
        powers: the number of the entry that gives a surface its power, by the surface's name.
    """

    def __init__(self, entries, source: str, called: AbstractSet[str] = frozenset()):
        self.entries, self.source, self.called = entries, source, called
        self.powers: dict[str, int] = {}

    def means(self, entry, name: str) -> bool:
        """Return whether an entry holds for the surface of this name."""
        return name == entry.name if entry.name in self.called else _matches(name, entry.name)

    def apply(self, part: Part) -> Part:
        """A part with what the entries say, but for powers: they need the areas of all parts."""
        material, flipped, emissivity, clear = part.material, False, None, False
        for number, entry in enumerate(self.entries):
            if not self.means(entry, part.name):
                continue
            emissivity = of_sides(emissivity, entry.emissivity)
            if entry.reflectance is not None:
                of_side = {"reflectance": tuple(entry.reflectance), "back_reflectance": None, "diffuse": True}
                material = replace(material, **of_side, given=max(entry.reflectance) < 1, origin=self.source)
                part = replace(part, color=None, texture=None)
                material = replace(material, refractive_index=0.0 if any(entry.reflectance) else material.refractive_index)
            if entry.transmittance is not None:
                material = replace(material, **clear_light(entry, part.name, self.source))
                clear = entry.transmittance > 0
            if entry.diffuse_transmittance is not None:
                some = any(entry.diffuse_transmittance)
                material = replace(material, diffuse_transmittance=tuple(entry.diffuse_transmittance) if some else None)
                material = replace(material, back=Back.RADIATES) if some else material
                clear |= some
            exitance = _exitance(entry)
            if exitance is not None:
                material = replace(material, emission=exitance, back_emission=None)
                part = replace(part, emission_texture=None, emission_color=None)
                self.powers.pop(part.name, None)
                if entry.power is not None:
                    self.powers[part.name] = number
            if entry.sides is not None:
                material = replace(material, back=SIDES[entry.sides])
            if entry.back is not None:
                material = replace(material, back=BACKS[entry.back])
            flipped = flipped if entry.flip is None else entry.flip
            if entry.patch_size is not None:
                part = replace(part, patch_size=entry.patch_size)
        material = reflecting(material, emissivity, self.source, part.name)
        part = replace(part, material=material)
        if clear:
            check_pane(part, self.source)
        return replace(part, faces=_turned(np.asarray(part.faces)) if flipped else part.faces)

    def with_powers(self, scene: Scene, source: str) -> Scene:
        """The scene with powers as exitances: they are spread over the radiating sides of all faces that an entry holds for."""
        emission, back = scene.emission.copy(), scene.back_emission.copy()
        areas = scene.area * np.where(scene.back == Back.RADIATES, 2, 1)
        for number in sorted(set(self.powers.values())):
            surfaces = [i for i, name in enumerate(scene.names) if self.powers.get(name) == number]
            faces = np.isin(scene.surface, surfaces)
            if not faces.any():
                raise SceneError(f"{source}: surface {number + 1} ('{self.entries[number].name}') has a power but no area")
            emission[faces] = back[faces] = np.asarray(self.entries[number].power) / areas[faces].sum()
            if not (emission[faces] < LARGEST).all():
                name, power, area = self.entries[number].name, self.entries[number].power, areas[faces].sum()
                text = f"has a power of {power} on {area:.3g} m²; the exitance must be below {LARGEST:g}"
                raise SceneError(f"{source}: surface {number + 1} ('{name}') {text}")
        return replace(scene, emission=emission, back_emission=back)


def _geometry(file: str, factor: float, name: str | None, looks: Looks, options: ReadOptions, source: Path) -> Scene:
    path = named_file(source, file, options, "geometry")
    if path.suffix.lower() == ".toml":
        raise SceneError(f"{source}: geometry '{path.name}' is a .toml file; name its geometry files instead")

    def edit(parts: list[Part]) -> list[Part]:
        result = []
        for part in parts:
            part = replace(part, name=_prefixed(part.name, name, path.stem), vertices=np.asarray(part.vertices) * factor)
            result.append(looks.apply(part))
        return result

    if options.read is None:
        raise SceneError(f"{source}: read it by `scene.formats.read`, which reads its geometry files too")
    scene = options.read(path, replace(options, edit=edit, unit=factor))
    cameras = [replace(c, origin=_times(c.origin, factor), target=_times(c.target, factor)) for c in scene.cameras]
    return replace(scene, cameras=tuple(cameras), lights=scaled(scene.lights, factor))


def _turned(faces: np.ndarray) -> np.ndarray:
    """Faces, (n, 3 or 4), that run round the other way: their fronts look to where their backs did."""
    turned = np.concatenate([faces[:, :1], faces[:, :0:-1]], axis=1)
    triangles = faces[:, -1] < 0  # whose last column stands for no corner
    turned[triangles] = faces[triangles][:, [0, 2, 1, 3]] if faces.shape[1] == 4 else turned[triangles]
    return turned


def _prefixed(name: str, prefix: str | None, stem: str) -> str:
    """A name with its prefix; the prefix alone for a file that names nothing itself."""
    if not prefix:
        return name
    return prefix if name == stem else f"{prefix}/{name}"


def _times(point, factor: float) -> tuple[float, float, float]:
    x, y, z = point
    return x * factor, y * factor, z * factor


def _matches(name: str, pattern: str) -> bool:
    return name == pattern or fnmatchcase(name, pattern)


def _exitance(entry) -> tuple[float, ...] | None:
    """The exitance of an entry, W/m²; zeros, as many as there are bands, where the entry gives a power."""
    if entry.radiance is not None:
        return tuple(np.pi * v for v in entry.radiance)
    if entry.power is not None:
        return tuple(0.0 for _ in entry.power)
    return None if entry.emission is None else tuple(entry.emission)


def _photometric(asked: bool | None, scenes: list[Scene], path: Path) -> bool:
    if asked is not None:
        return asked
    lit = [scene for scene in scenes if scene.lights or (scene.emission > 0).any() or (scene.back_emission > 0).any()]
    found = {scene.photometric for scene in lit}
    if len(found) > 1:
        raise SceneError(f"{path}: some geometry files emit in lm/m², others in W/m²; set photometric = true or false")
    return any(found) if found else any(scene.photometric for scene in scenes)
