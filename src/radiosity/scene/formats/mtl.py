"""Materials of Wavefront MTL files."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ...errors import SceneError, shown
from ..assemble import Material, ReadOptions, warn
from ..model import Back
from .textures import linear_image

# options of map_Kd and map_Ke, and how many values follow (-o, -s, -t: one to three numbers)
OPTIONS = {"-blendu": 1, "-blendv": 1, "-boost": 1, "-mm": 2, "-texres": 1, "-clamp": 1, "-bm": 1, "-imfchan": 1, "-type": 1,
           "-cc": 1, "-colorspace": 1, "-o": 3, "-s": 3, "-t": 3}  # fmt: skip


@dataclass(frozen=True, eq=False)
class Map:
    """An image with scale and offset of the texture coordinates."""

    image: np.ndarray
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)

    def uv(self, given: np.ndarray) -> np.ndarray:
        return given * self.scale + self.offset


@dataclass(frozen=True, eq=False)
class Finish:
    """A material with its textures."""

    material: Material
    base: Map | None = None
    emissive: Map | None = None


def read_library(path: Path, options: ReadOptions) -> dict[str, Finish]:
    """The materials of a library by name. ``Kd`` is the reflectance, ``Ke`` a radiance.

    Textures that are missing or damaged are left out with one warning (an error where ``options.strict``).

    Raises:
        SceneError: a value that is no number.
    """
    entries: dict[str, dict[str, tuple[int, str]]] = {}
    current: dict[str, tuple[int, str]] = {}
    for number, line in enumerate(read_text(path).splitlines(), 1):
        words = line.split("#", 1)[0].split(None, 1)
        if not words:
            continue
        rest = words[1].strip() if len(words) > 1 else ""
        if words[0].lower() == "newmtl":
            current = entries.setdefault(rest, {})
        else:
            current[words[0].lower()] = (number, rest)
    lost: list[str] = []
    images: dict[Path, np.ndarray] = {}
    result = {name: _finish(path, entry, images, lost, options) for name, entry in entries.items()}
    if lost:
        warn(f"{path}: textures that cannot be read are left out: {'; '.join(dict.fromkeys(lost))}")
    see_through = [
        name for name, entry in entries.items() if _number(path, entry, "d", 1.0) < 1 or _number(path, entry, "tr", 0.0) > 0
    ]
    if see_through:
        warn(f"{path}: transparency is left out, taken as opaque: {shown(see_through)}")
    return result


def read_text(path: Path) -> str:
    """UTF-8, or Latin-1 where it is not; lines that end in a backslash are joined."""
    data = path.read_bytes()
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return re.sub(r"\\\r?\n", " ", text)


def _finish(path: Path, entry: dict, images: dict, lost: list[str], options: ReadOptions) -> Finish:
    base, emissive = (_map(path, entry, key, images, lost, options) for key in ("map_kd", "map_ke"))
    diffuse = _color(path, entry, "kd")
    radiance = _color(path, entry, "ke") or (0.0,)
    if diffuse is None and base is not None:
        diffuse = (1.0,)
    specular = max(_color(path, entry, "ks") or (0.0,))
    illumination = _number(path, entry, "illum", 2.0)
    # many programs write Ks 0.5 with illum 2 for everything: only what outweighs Kd, or is traced as a mirror, counts
    glossy = (illumination >= 3 and specular > 0) or (illumination >= 2 and specular > max(diffuse or (1.0,)))
    material = Material(
        reflectance=diffuse,
        emission=tuple(np.pi * v for v in radiance),
        back=Back.RADIATES,
        diffuse=not (glossy or _number(path, entry, "pm", 0.0) > 0),
    )
    return Finish(material, base, emissive if any(radiance) else None)


def _floats(path: Path, entry: dict, key: str) -> list[float] | None:
    if key not in entry:
        return None
    line, rest = entry[key]
    try:
        return [float(word) for word in rest.split()]
    except ValueError:
        raise SceneError(f"{path}, line {line}: '{key} {rest}' is not understood; expected numbers") from None


def _number(path: Path, entry: dict, key: str, default: float) -> float:
    if key == "d" and key in entry:
        entry = {key: (entry[key][0], entry[key][1].replace("-halo", ""))}
    values = _floats(path, entry, key)
    return values[0] if values else default


def _color(path: Path, entry: dict, key: str) -> tuple[float, ...] | None:
    values = _floats(path, entry, key)
    if not values:
        return None
    values = values[:3] if len(values) >= 3 else values[:1]
    if not all(0 <= v < np.inf for v in values):
        raise SceneError(f"{path}, line {entry[key][0]}: {key} is {shown(values)}; values must be finite and not negative")
    return tuple(values[:1] if len(set(values)) == 1 else values)


def _map(path: Path, entry: dict, key: str, images: dict, lost: list[str], options: ReadOptions) -> Map | None:
    if key not in entry:
        return None
    words = re.split(r"\s+", entry[key][1])
    moves = {"-o": [0.0, 0.0], "-s": [1.0, 1.0]}
    while words and words[0].lower() in OPTIONS:
        option = words.pop(0).lower()
        for place in range(OPTIONS[option]):
            if len(words) < 2 or (option in ("-o", "-s", "-t") and not _is_number(words[0])):
                break
            value = words.pop(0)
            if option in moves and place < 2:
                moves[option][place] = float(value)
    name = " ".join(words)
    try:
        file = _find(path, name)
        if file not in images:
            images[file] = linear_image(file.read_bytes(), str(file))
    except (SceneError, OSError, ValueError) as error:
        if options.strict:
            raise SceneError(f"{path}, line {entry[key][0]}: texture '{name}': {error}") from None
        lost.append(str(error))
        return None
    return Map(images[file], tuple(moves["-s"]), tuple(moves["-o"]))


def _is_number(word: str) -> bool:
    return re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", word) is not None


def _find(path: Path, name: str) -> Path:
    """A texture file: as named, or of that name beside the library (names of other machines are common)."""
    plain = name.strip('"').replace("\\", "/")
    for file in (path.parent / plain, path.parent / Path(plain).name):
        if plain and file.is_file():
            return file
    raise SceneError(f"'{name}' does not exist beside {path.name}")
