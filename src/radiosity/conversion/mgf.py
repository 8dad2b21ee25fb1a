"""The Materials and Geometry Format (MGF): a material and faces for each surface. Numbers keep all their digits.

MGF is photometric: light in W is multiplied by 179 lm/W, as Radiance's programs do. Its faces look alike from both sides, or are
invisible from behind (``sides 1``). A face whose sides differ becomes two of the latter.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..scene.formats.color import chromaticity, is_neutral, luminance_weights
from ..scene.model import Back, Scene
from ..solution.whole import whole_file
from .names import plain_word, unique_names
from .pieces import BEHIND, Piece, glowing, pieces, tell_of_rest, turned
from .plain import plain
from .radiance import LUMENS
from .sheets import gap_of, sheet
from .told import Told

HOLDS = frozenset({"names", "reflectance", "emission", "units", "backs", "panes", "diffusing panes"})
GREY = (1 / 3, 1 / 3)


def write(scene: Scene, path: Path, told: Told) -> None:
    """Write the file.

    Raises:
        OutputError: it cannot be written.
    """
    tell_of_rest(scene, told, HOLDS)
    if not scene.photometric:
        told.add(f"light in W becomes light in lm, multiplied by {LUMENS:g} lm/W", glowing(scene))
    lumens = 1.0 if scene.photometric else LUMENS
    gap = gap_of(scene)
    parts = [side for piece in pieces(plain(scene, of_surfaces=True), told, backs="kept") for side in _sides(piece, gap, told)]
    names = unique_names([side.piece for side in parts], told, plain_word)
    with whole_file(path) as file:
        file.write(b"# written by radiosity; lengths in metres\n")
        for side, name in zip(parts, names, strict=True):
            file.write("\n".join(_material(name, side, lumens, told)).encode() + b"\n")
            one = sheet(scene, side.piece, gap if side.is_back else 0.0)
            points = enumerate(one.vertices.tolist())
            file.write("".join(f"v v{i} =\n\tp {x!r} {y!r} {z!r}\n" for i, (x, y, z) in points).encode())
            file.write("".join(f"f {' '.join(f'v{i}' for i in row if i >= 0)}\n" for row in one.faces.tolist()).encode())


@dataclass(frozen=True, eq=False)
class _Side:
    """A piece that looks alike from both sides, or is invisible from behind; a back lies a little behind its front."""

    piece: Piece
    one_sided: bool
    is_back: bool = False


def _sides(piece: Piece, gap: float, told: Told) -> Iterator[_Side]:
    lit, radiates = piece.emission.any(), piece.back == Back.RADIATES
    differs = (piece.reflectance != piece.back_reflectance).any() or (piece.emission != piece.back_emission).any()
    if piece.back in (Back.PASSES, Back.OPEN):
        yield _Side(piece, True)
    elif radiates and not differs:
        yield _Side(piece, False)
    elif radiates and (piece.transmittance or piece.diffuse.any()):
        told.add("backs that reflect or emit otherwise get the values of their fronts", [piece.name])
        yield _Side(piece, False)
    elif not radiates and not lit:
        told.add("one-sided surfaces read back as two-sided", [piece.name])
        yield _Side(piece, False)
    else:
        told.add(f"sides that differ become two surfaces, {gap:.2g} m apart, the second called NAME{BEHIND}", [piece.name])
        yield _Side(piece, True)
        back = {"reflectance": piece.back_reflectance, "emission": piece.back_emission} if radiates else {}
        black = {"reflectance": 0 * piece.reflectance, "emission": 0 * piece.emission}
        yield _Side(replace(piece, name=piece.name + BEHIND, corners=turned(piece.corners), **(black | back)), True, is_back=True)


def _material(name: str, side: _Side, lumens: float, told: Told) -> Iterator[str]:
    """Yield the lines of a material."""
    yield f"m {name} ="
    yield f"\tsides {1 if side.one_sided else 2}"
    piece = side.piece
    values = (("rd", piece.reflectance), ("td", piece.diffuse), ("ed", piece.emission * lumens))
    for key, color in values:
        if not color.any():
            continue
        value, (x, y) = _with_color(color)
        if is_neutral(x, y) and np.ptp(color) > 0:
            told.add("colours that are almost grey become grey", [piece.name])
        yield "\tc" if (x, y) == GREY else f"\tc\n\t\tcxy {x!r} {y!r}"
        yield f"\t{key} {value!r}"
    if piece.transmittance:
        yield f"\tc\n\tts {piece.transmittance!r} 0"


def _with_color(color: np.ndarray) -> tuple[float, tuple[float, float]]:
    """The luminance of a colour, and its chromaticity."""
    if np.ptp(color) == 0:
        return float(color[0]), GREY
    return float(luminance_weights() @ color), chromaticity(color)
