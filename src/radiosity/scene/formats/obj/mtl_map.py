"""Textures of MTL materials: options, files, images."""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ....errors import SceneError
from ...parts import ReadOptions
from ...sampler import DEFAULT_SAMPLER, Sampler
from ..beside import in_any_case
from ..textures import linear_image

# options of map_Kd and map_Ke, and how many values follow (-o, -s, -t: one to three numbers)
OPTIONS = {
    "-blendu": 1,
    "-blendv": 1,
    "-boost": 1,
    "-mm": 2,
    "-texres": 1,
    "-clamp": 1,
    "-bm": 1,
    "-imfchan": 1,
    "-type": 1,
    "-cc": 1,
    "-colorspace": 1,
    "-o": 3,
    "-s": 3,
    "-t": 3,
}
# those that would change the colours and are not followed, with the values at which they change nothing
UNCHANGED = {"-t": ("0", "0", "0"), "-mm": ("0", "1"), "-cc": ("off",)}
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


@dataclass(frozen=True, eq=False)
class Map:
    """An image with scale and offset of the texture coordinates, and how it is continued."""

    image: np.ndarray
    scale: np.ndarray
    offset: np.ndarray
    sampler: Sampler = DEFAULT_SAMPLER

    def uv(self, given: np.ndarray) -> np.ndarray:
        return given * self.scale + self.offset


@dataclass(eq=False)
class Maps:
    """The textures of a library; each image is read once."""

    path: Path
    options: ReadOptions
    images: dict[Path, np.ndarray] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)
    renamed: list[tuple[str, Path]] = field(default_factory=list)  # found under a name of other case
    ignored: dict[str, None] = field(default_factory=dict)

    def read(self, line: int, text: str) -> Map | None:
        """The texture of a ``map_`` statement; what cannot be read is noted in ``lost`` (an error where strict)."""
        words = text.split()
        moves = {"-o": [0.0, 0.0], "-s": [1.0, 1.0]}
        clamp = "off"
        while words and words[0].lower() in OPTIONS:
            option, values = words.pop(0).lower(), []
            for place in range(OPTIONS[option]):
                if len(words) < 2 or (option in ("-o", "-s", "-t") and not NUMBER.fullmatch(words[0])):
                    break
                values.append(words.pop(0))
                if option in moves and place < 2:
                    moves[option][place] = float(values[-1])
            if option == "-clamp":
                clamp = "".join(values).lower()
            if option in UNCHANGED and not _as_default(values, UNCHANGED[option]):
                self.ignored[f"{option} {' '.join(values)}"] = None
        name = " ".join(words)
        try:
            file = self._find(name)
        except (OSError, ValueError) as error:
            return self._lose(line, name, error)
        self.options.admit(file, f"{self.path}, line {line}")
        try:
            if file not in self.images:
                self.images[file] = linear_image(file.read_bytes(), str(file), self.options)
        except (OSError, ValueError) as error:
            return self._lose(line, name, error)
        sampler = Sampler(("clamp", "clamp")) if clamp == "on" else DEFAULT_SAMPLER
        return Map(self.images[file], np.array(moves["-s"]), np.array(moves["-o"]), sampler)

    def _lose(self, line: int, name: str, error: Exception) -> None:
        if self.options.strict:
            raise SceneError(f"{self.path}, line {line}: texture '{name}': {error}") from None
        self.lost.append(str(error))

    def _find(self, name: str) -> Path:
        """The file of this name, or of its last part beside the library: names of other machines are common."""
        plain = name.strip('"').replace("\\", "/")
        for file in (self.path.parent / plain, self.path.parent / Path(plain).name):
            if plain and file.is_file():
                return file
        if plain and (file := in_any_case(self.path.parent, plain) or in_any_case(self.path.parent, Path(plain).name)):
            self.renamed.append((plain, file))
            return file
        raise SceneError(f"'{name}' does not exist beside {self.path.name}")


def _as_default(values: list[str], default: tuple[str, ...]) -> bool:
    """Return whether an option has its default value."""
    pairs = list(zip(values, default, strict=False))
    return all(v.lower() == d or (NUMBER.fullmatch(v) and NUMBER.fullmatch(d) and float(v) == float(d)) for v, d in pairs)
