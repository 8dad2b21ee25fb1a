"""Reflectances, radiances and textures of Mitsuba's plugins as linear RGB, or one number where they are grey."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ....errors import SceneError, shown
from ...parts import ReadOptions
from ...sampler import DEFAULT_SAMPLER, WRAPS, Sampler
from .image import find_file, read_image
from .node import Node, Spectrum

PLAIN = {"srgb": "color", "uniform": "value", "rawconstant": "value", "d65": "color"}  # plugin: its argument
FILTERS = {"bilinear": "linear", "nearest": "nearest"}

Color = tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Image:
    """A texture: linear (height, width, 1 or 3), row 0 at Mitsuba's v = 0; ``to_uv`` (3, 3) acts on (u, v, 1)."""

    pixels: np.ndarray
    to_uv: np.ndarray
    sampler: Sampler = DEFAULT_SAMPLER

    def coordinates(self, uv: np.ndarray) -> np.ndarray:
        """Return texture coordinates of a paint, (n, 2), whose v grows from the last row to the first, from those of Mitsuba."""
        u, v = (np.column_stack([uv, np.ones(len(uv))]) @ self.to_uv.T).T[:2]
        return np.column_stack([u, 1 - v])

    @property
    def mean(self) -> Color:
        return collapse(self.pixels.mean(axis=(0, 1), dtype=np.float64))


@dataclass(frozen=True)
class VertexColors:
    """Colours that the mesh brings along: an attribute of its vertices or faces, times a number."""

    name: str
    scale: float = 1.0


def collapse(color) -> Color:
    """One number where all are equal."""
    values = tuple(float(v) for v in color)
    return values[:1] if len(set(values)) == 1 else values


class Colors:
    """A reader of colours; images are found in ``folders`` and read once."""

    def __init__(self, folders: list[Path], options: ReadOptions):
        self._folders, self._options = folders, options
        self._images: dict[tuple[Path, bool], np.ndarray] = {}

    def get(self, node: Node, key: str, default: float, *, emission: bool = False) -> "Color | Image | VertexColors":
        """The argument ``key`` of a plugin.

        Raises:
            SceneError: an image that cannot be read, or what Mitsuba cannot evaluate in RGB.
        """
        nested = node.child(key)
        if nested is not None:
            return self._texture(nested, emission)
        value = node.values.get(key, default)
        if isinstance(value, Spectrum):
            flat = not value.wavelengths
            return value.values[:1] if flat else collapse(_srgb(value.wavelengths, value.values, emission, node.place))
        color = np.atleast_1d(np.asarray(value)) if not isinstance(value, str) else np.zeros(0)
        if color.shape not in ((1,), (3,)):
            raise SceneError(f"{node.place}: '{key}' of this '{node.plugin}' is {value!r}; expected a colour")
        return collapse(color)

    def _texture(self, node: Node, emission: bool) -> "Color | Image | VertexColors":
        to_uv = node.values.get("to_uv", np.eye(4))
        if np.shape(to_uv) != (4, 4):
            raise SceneError(f"{node.place}: 'to_uv' of this '{node.plugin}' is {to_uv!r}; expected a transformation")
        to_uv = to_uv[np.ix_((0, 1, 3), (0, 1, 3))]
        if node.plugin == "bitmap":
            return Image(self.bitmap(node), to_uv, _sampler(node))
        if node.plugin == "checkerboard":
            return Image(self._checkerboard(node), to_uv, Sampler(filter="nearest"))
        if node.plugin == "mesh_attribute":
            name = node.values.get("name")
            if not isinstance(name, str) or not name.startswith(("vertex_", "face_")):
                text = f"{node.place}: the name of a mesh_attribute is {name!r}"
                raise SceneError(f"{text}; expected one that begins with vertex_ or face_")
            return VertexColors(name, node.number("scale", 1.0))
        if node.plugin in PLAIN:
            color = self.get(node, PLAIN[node.plugin], 1.0, emission=emission)
            scale = node.number("scale", 1.0)
            return tuple(scale * v for v in color) if isinstance(color, tuple) else color
        if node.plugin in ("regular", "irregular"):
            return collapse(_srgb(*_samples(node), emission, node.place))
        raise SceneError(f"{node.place}: a '{node.plugin}' as a colour is not read; give an rgb, a spectrum or a bitmap")

    def bitmap(self, node: Node) -> np.ndarray:
        """The image of a plugin that names a file, (height, width, 1 or 3) float32, linear; it is read once.

        Raises:
            SceneError: there is none, or it cannot be decoded.
        """
        name = node.values.get("filename")
        if not isinstance(name, str):
            raise SceneError(f"{node.place}: this '{node.plugin}' has no filename")
        file = find_file(self._folders, name, node, self._options)
        raw = bool(node.values.get("raw", False))
        if (file, raw) not in self._images:
            self._images[file, raw] = read_image(file, raw, self._options)
        return self._images[file, raw]

    def _checkerboard(self, node: Node) -> np.ndarray:
        colors = [self.get(node, key, value) for key, value in (("color0", 0.4), ("color1", 0.2))]
        plain = [color.mean if isinstance(color, Image) else color for color in colors if not isinstance(color, VertexColors)]
        if len(plain) < 2:
            raise SceneError(f"{node.place}: a checkerboard of mesh attributes is not read; give an rgb")
        half = np.array([True, False])
        width = max(map(len, plain))
        first, second = (np.broadcast_to(color, width) for color in plain)
        return np.where((half[:, None] == half)[..., None], first, second).astype(np.float32)


def _sampler(node: Node) -> Sampler:
    """The sampler of a bitmap: how it is continued."""
    wrap, kind = node.values.get("wrap_mode", "repeat"), node.values.get("filter_type", "bilinear")
    if wrap not in WRAPS or kind not in FILTERS:
        text = f"{node.place}: wrap_mode {wrap!r} and filter_type {kind!r} of a bitmap"
        raise SceneError(f"{text}; expected one of {shown(WRAPS)}, and one of {shown(FILTERS)}")
    return Sampler((str(wrap), str(wrap)), FILTERS[str(kind)])


def equal_energy_rgb() -> np.ndarray:
    """Return the linear sRGB of a radiance that is 1 at all wavelengths, as Mitsuba converts it, (3,)."""
    return np.array(_srgb((360.0, 830.0), (1.0, 1.0), True, ""))


def _samples(node: Node) -> tuple[list[float], list[float]]:
    """Wavelengths and values of a sampled spectrum."""
    try:
        values = [float(v) for v in str(node.values.get("values", "")).replace(",", " ").split()]
        if node.plugin == "irregular":
            return [float(v) for v in str(node.values.get("wavelengths", "")).replace(",", " ").split()], values
    except ValueError as error:
        raise SceneError(f"{node.place}: the spectrum cannot be read ({error})") from None
    ends = node.number("wavelength_min", 360.0), node.number("wavelength_max", 830.0)
    return [float(v) for v in np.linspace(*ends, len(values))], values


def _srgb(wavelengths, values, emission: bool, place: str) -> list[float]:
    import mitsuba.scalar_rgb as rgb

    steps = np.diff(wavelengths)
    finite = np.isfinite((*wavelengths, *values)).all()
    if len(values) < 2 or len(wavelengths) != len(values) or not finite or not (steps > 0).all():
        text = f"{place}: a spectrum of {len(values)} values at {len(wavelengths)} wavelengths"
        raise SceneError(f"{text}; expected two or more finite ones, at growing wavelengths")
    try:
        return [float(v) for v in rgb.spectrum_list_to_srgb(list(wavelengths), list(values), not emission, not emission)]
    except (RuntimeError, TypeError) as error:
        raise SceneError(f"{place}: the spectrum cannot be converted to RGB ({error})") from None
