"""glTF materials by their diffuse albedo and emitted radiance."""

from dataclasses import dataclass, field, replace

import numpy as np

from ....errors import shown
from ...assemble import DEFAULT_REFLECTANCE, Material, warn
from ...model import Back
from ...sampler import DEFAULT_SAMPLER, Sampler
from ..color import luminance_weights
from ..mesh_colors import warn_of_bytes
from ..textures import linear_image, warn_of_black
from .extensions import GLOSSY
from .file import GltfFile

NOT_MIRRORED = 0.96  # of the light on a dielectric of index 1.5, at normal incidence
GLOSSY_ROUGHNESS = 0.3  # a material that is explicitly smoother counts as not diffuse
WRAPS = {10497: "repeat", 33648: "mirror", 33071: "clamp"}
FILTERS = {9728: "nearest", 9729: "linear"}


@dataclass(frozen=True, eq=False)
class Texture:
    """An image and how texture coordinates lead to it: set TEXCOORD_n, then scale, rotation (radians), offset."""

    image: np.ndarray
    coordinates: int = 0
    offset: tuple[float, ...] = (0.0, 0.0)
    rotation: float = 0.0
    scale: tuple[float, ...] = (1.0, 1.0)
    sampler: Sampler = DEFAULT_SAMPLER

    def uv(self, given: np.ndarray) -> np.ndarray:
        """Texture coordinates of a paint (origin at the lower left) from those of glTF (upper left)."""
        c, s = np.cos(self.rotation), np.sin(self.rotation)
        moved = (given * self.scale) @ np.array([[c, -s], [s, c]]) + self.offset
        return np.column_stack([moved[:, 0], 1.0 - moved[:, 1]])


@dataclass(frozen=True, eq=False)
class Finish:
    """A material with its textures; ``plain``: it gives no base colour of its own."""

    name: str
    material: Material
    base: Texture | None = None
    emissive: Texture | None = None
    plain: bool = False


@dataclass(eq=False)
class Materials:
    """The materials of a file, read when first asked for; `report` tells once what was not taken as it is."""

    file: GltfFile
    finishes: dict[int, Finish] = field(default_factory=dict)
    images: dict[int, np.ndarray] = field(default_factory=dict)
    transparent: list[str] = field(default_factory=list)
    panes: dict[str, float] = field(default_factory=dict)  # transmittances
    diffusers: dict[str, None] = field(default_factory=dict)  # single-sided materials that diffuse light
    averaged: dict[str, None] = field(default_factory=dict)  # materials whose diffused light has the mean colour of an image
    unlit: list[str] = field(default_factory=list)
    colorless: dict[str, None] = field(default_factory=dict)
    bytes: dict[str, None] = field(default_factory=dict)  # objects whose vertex colours are counted from 0 to 255
    black: dict[str, str] = field(default_factory=dict)  # materials with an image that a factor of zero makes black

    def __getitem__(self, index) -> Finish:
        info = self.file.item("materials", index)
        if index not in self.finishes:
            self.finishes[index] = self._read(info, str(info.get("name") or f"material {index}"))
        return self.finishes[index]

    def of(self, index, colored: bool) -> Finish:
        """The material for a primitive, which may have vertex colours. Without any colour it is white metal by the letter of
        glTF, as programs write it that could not export a material: its reflectance is not known."""
        finish = self[index]
        if not finish.plain or colored:
            return finish
        self.colorless[finish.name] = None
        return replace(finish, material=replace(finish.material, reflectance=(DEFAULT_REFLECTANCE,)))

    def report(self) -> None:
        if self.colorless:
            warn(
                f"{self.file.path}: materials without a base colour (by default white metal, which exporters write where they "
                f"cannot convert one): reflectance {DEFAULT_REFLECTANCE} taken for {shown(self.colorless)}"
            )
        warn_of_black(self.file.path, self.black)
        warn_of_bytes(self.file.path, self.bytes)
        if self.unlit:
            warn(f"{self.file.path}: unlit materials are taken as diffuse ones of their base colour: {shown(self.unlit)}")
        if self.panes:
            told = shown([f"{name} ({value:.3g})" for name, value in self.panes.items()])
            warn(f"{self.file.path}: transmission makes clear panes, with one transmittance for all angles and colours: {told}")
        if self.diffusers:
            text = "materials that transmit diffusely are two-sided here, though the file calls them single-sided"
            warn(f"{self.file.path}: {text}: {shown(self.diffusers)}")
        if self.averaged:
            text = "diffuse transmission has the mean colour of its image everywhere"
            warn(f"{self.file.path}: {text}: {shown(self.averaged)}")
        if self.transparent:
            text = "transparency is left out, taken as opaque"
            warn(f"{self.file.path}: {text}: {shown(self.transparent)}; transmittance in a .toml makes panes")

    def _read(self, info: dict, name: str) -> Finish:
        file, what = self.file, f"material '{name}'"
        extensions = file.dictionary(info.get("extensions", {}), f"extensions of {what}")
        metal = file.dictionary(info.get("pbrMetallicRoughness", {}), f"pbrMetallicRoughness of {what}")
        shiny = extensions.get("KHR_materials_pbrSpecularGlossiness")
        if isinstance(shiny, dict):
            colors, key = shiny, "diffuse"
        else:
            colors, key = metal, "baseColor"
        factor, texture = file.numbers(colors, f"{key}Factor", (1.0,) * 4, what), colors.get(f"{key}Texture")
        if "KHR_materials_unlit" in extensions:
            self.unlit.append(name)
        strength = file.dictionary(extensions.get("KHR_materials_emissive_strength", {}), f"emissive strength of {what}")
        (power,) = file.numbers({"v": [strength.get("emissiveStrength", 1.0)]}, "v", (1.0,), f"emissiveStrength of {what}")
        radiance = np.array(file.numbers(info, "emissiveFactor", (0.0,) * 3, what)) * power
        strong = "emissiveStrength" in strength and power > 0
        if (info.get("emissiveTexture") is not None or strong) and not radiance.any():
            self.black[name] = "emissiveFactor" if power > 0 else "emissiveStrength"
        if texture is not None and not any(factor[:3]):
            self.black[name] = f"{key}Factor"
        if info.get("alphaMode", "OPAQUE") != "OPAQUE":
            self.transparent.append(name)
        base = self._texture(texture, what)
        through, transmittance = self._transmission(extensions, factor[:3], base, name)
        share, diffused = self._diffuse_transmission(extensions, name)
        if diffused is not None and info.get("doubleSided") is not True:
            self.diffusers[name] = None
        kept = (1 - through) * (1 - share)
        material = Material(
            reflectance=_unless_grey(tuple(value * kept for value in factor[:3]) if kept < 1 else factor[:3]),
            diffuse_transmittance=None if diffused is None else _unless_grey((1 - through) * diffused),
            transmittance=transmittance,
            emission=_unless_grey(np.pi * radiance),
            back=Back.RADIATES if info.get("doubleSided") is True or diffused is not None else Back.ABSORBS,
            diffuse=not self._is_glossy(metal, extensions, what),
        )
        emissive = self._texture(info.get("emissiveTexture"), what) if radiance.any() else None
        plain = f"{key}Factor" not in colors and texture is None
        return Finish(name, material, base, emissive, plain)

    def _transmission(self, extensions: dict, color, base: Texture | None, name: str) -> tuple[float, float]:
        """Return the factor of KHR_materials_transmission, and the transmittance that it makes; zeros where it is not read.

        Light that is not mirrored goes through with the base colour: at normal incidence, and with the usual index of 1.5,
        4 % are mirrored. A texture of the factor is not read.
        """
        what = f"transmission of '{name}'"
        held = self.file.dictionary(extensions.get("KHR_materials_transmission", {}), what)
        (factor,) = self.file.numbers({"v": [held.get("transmissionFactor", 0.0)]}, "v", (0.0,), what)
        if not 0 <= factor <= 1:
            raise self.file.fail(f"{what} has the factor {factor:g}; it must lie between 0 and 1")
        if factor and "transmissionTexture" in held:
            self.transparent.append(name)
        if "transmissionTexture" in held or not factor:
            return 0.0, 0.0
        mean = np.ones(3) if base is None else np.broadcast_to(base.image.mean(axis=(0, 1)), (3,))
        self.panes[name] = transmittance = factor * NOT_MIRRORED * min(float(luminance_weights() @ (mean * color)), 1.0)
        return factor, transmittance

    def _diffuse_transmission(self, extensions: dict, name: str) -> tuple[float, np.ndarray | None]:
        """Return the factor of KHR_materials_diffuse_transmission, and the transmittance that it makes, (3,); None: nothing.

        The factor is the share of diffuse light that is transmitted and not reflected, in a colour of its own. A texture of the
        factor is not read, and one of the colour has its mean everywhere.
        """
        what = f"diffuse transmission of '{name}'"
        held = self.file.dictionary(extensions.get("KHR_materials_diffuse_transmission", {}), what)
        (factor,) = self.file.numbers({"v": [held.get("diffuseTransmissionFactor", 0.0)]}, "v", (0.0,), what)
        color = np.array(self.file.numbers(held, "diffuseTransmissionColorFactor", (1.0,) * 3, what))
        if not (0 <= factor <= 1 and (color >= 0).all() and (color <= 1).all()):
            raise self.file.fail(
                f"{what} has the factor {factor:g} and the colour {color.tolist()}; they must lie between 0 and 1"
            )
        if factor and "diffuseTransmissionTexture" in held:
            self.transparent.append(name)
        if "diffuseTransmissionTexture" in held or not factor * color.any():
            return 0.0 if "diffuseTransmissionTexture" in held else factor, None
        texture = self._texture(held.get("diffuseTransmissionColorTexture"), what)
        if texture is not None:
            self.averaged[name] = None
            color = color * texture.image.mean(axis=(0, 1))
        return factor, factor * color

    def _is_glossy(self, metal: dict, extensions: dict, what: str) -> bool:
        """Return whether the file states that the material is glossy.

        The default (fully metallic) of files that leave it out means nothing.
        """
        textured = "metallicRoughnessTexture" in metal
        metallic, rough = (
            self.file.numbers({"v": [metal.get(key, default)]}, "v", (0.0,), f"{key} of {what}")[0]
            for key, default in (("metallicFactor", 1.0 if textured else 0.0), ("roughnessFactor", 1.0))
        )
        others = False
        for key, (factor, default) in GLOSSY.items():
            held = self.file.dictionary(extensions.get(key, {}), f"{key} of {what}")
            one = isinstance(default, float)
            given = {factor: [held.get(factor, default)]} if one else held
            others |= any(self.file.numbers(given, factor, (default,) if one else default, what))
        key = "KHR_materials_pbrSpecularGlossiness"
        shiny = self.file.dictionary(extensions.get(key, {}), f"{key} of {what}")
        (smooth,) = self.file.numbers({"v": [shiny.get("glossinessFactor", 0.0)]}, "v", (0.0,), f"glossinessFactor of {what}")
        others |= smooth > 1 - GLOSSY_ROUGHNESS and "specularGlossinessTexture" not in shiny
        return metallic > 0 or (rough < GLOSSY_ROUGHNESS and not textured) or others

    def _texture(self, use, what: str) -> Texture | None:
        if use is None:
            return None
        file = self.file
        use = file.dictionary(use, f"a texture of {what}")
        info = file.item("textures", use.get("index"))
        webp = file.dictionary(info.get("extensions", {}), "extensions of a texture").get("EXT_texture_webp")
        source = webp.get("source") if isinstance(webp, dict) else info.get("source")
        if source is None:
            raise file.fail(
                f"a texture of {what} has no image that is read (extensions {shown(info.get('extensions', {}))}); use PNG or JPEG"
            )
        move = file.dictionary(
            file.dictionary(use.get("extensions", {}), "extensions").get("KHR_texture_transform", {}), "transform"
        )
        return Texture(
            self._image(source),
            file.whole(move, "texCoord", what) if "texCoord" in move else file.whole(use, "texCoord", what, 0),
            file.numbers(move, "offset", (0.0, 0.0), what),
            file.numbers({"rotation": [move.get("rotation", 0.0)]}, "rotation", (0.0,), what)[0],
            file.numbers(move, "scale", (1.0, 1.0), what),
            self._sampler(info, what),
        )

    def _sampler(self, info: dict, what: str) -> Sampler:
        """How a texture's image is continued; what is not said is repeated, and linear."""
        if "sampler" not in info:
            return DEFAULT_SAMPLER
        held = self.file.item("samplers", info["sampler"])
        values = []
        for key, known in (("wrapS", WRAPS), ("wrapT", WRAPS), ("magFilter", FILTERS)):
            value = held.get(key, 9729 if known is FILTERS else 10497)
            if not isinstance(value, int) or value not in known:
                raise self.file.fail(f"{key} of the sampler of a texture of {what} is {value!r}; expected one of {shown(known)}")
            values.append(known[value])
        return Sampler((values[0], values[1]), values[2])

    def _image(self, index) -> np.ndarray:
        info = self.file.item("images", index)
        if index not in self.images:
            what = f"image {index}" + (f" ('{info['name']}')" if info.get("name") else "")
            packed = "bufferView" in info
            data = bytes(self.file.view(info["bufferView"])[0]) if packed else self.file.resource(info.get("uri"), what)
            self.images[index] = linear_image(data, f"{self.file.path}: {what}", self.file.options)
        return self.images[index]


def _unless_grey(values) -> tuple[float, ...]:
    """One number where three are equal: a file without colours is a grey scene."""
    values = tuple(float(v) for v in values)
    return values[:1] if len(set(values)) == 1 else values
