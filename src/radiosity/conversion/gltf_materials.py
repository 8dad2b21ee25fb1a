"""glTF materials of pieces: colours, strengths of emission, transmission, and textures."""

import io
from dataclasses import dataclass, field

import numpy as np

from ..image.glb import Buffer
from ..image.tone import srgb
from ..scene.formats.color import luminance_weights
from ..scene.formats.gltf.material import FILTERS, NOT_MIRRORED, WRAPS
from ..scene.formats.textures import decode_srgb
from ..scene.model import Back, Scene
from ..scene.paint import Paint
from .pieces import Piece
from .told import Told

ROUNDED = 2e-3  # of 1: a larger change by 8 bits is told
STRENGTH, TRANSMISSION = "KHR_materials_emissive_strength", "KHR_materials_transmission"
DIFFUSION = "KHR_materials_diffuse_transmission"
CODES = {name: code for code, name in (WRAPS | FILTERS).items()}


@dataclass(eq=False)
class Materials:
    """The materials of a file, with their textures; each image and sampler is written once."""

    scene: Scene
    buffer: Buffer
    told: Told
    materials: list[dict] = field(default_factory=list)
    images: list[dict] = field(default_factory=list)
    samplers: list[dict] = field(default_factory=list)
    textures: list[dict] = field(default_factory=list)
    used: set[str] = field(default_factory=set)
    known: dict[tuple[str, int], tuple[int, float]] = field(default_factory=dict)

    def add(self, piece: Piece, images: tuple[int, int]) -> int:
        """Add the material of a piece and return its number.

        Args:
            images: numbers of the images of reflectance and of emission; -1 where there is none.
        """
        colour, extensions = self._through(piece)
        metal: dict = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
        material: dict = {"name": piece.name, "doubleSided": piece.back == Back.RADIATES}
        radiance = _three(piece.emission) / np.pi
        if images[0] >= 0:
            metal["baseColorTexture"], scale = self._texture("reflectance", images[0], 0)
            colour = colour * scale
        if images[1] >= 0:
            material["emissiveTexture"], scale = self._texture("emission", images[1], 1)
            radiance = radiance * scale
        if (colour > 1).any():
            self.told.add("reflectances above 1 before a texture are brought down to 1", [piece.name])
        metal["baseColorFactor"] = [*np.minimum(colour, 1.0).tolist(), 1.0]
        if radiance.any():
            strength = float(max(radiance.max(), 1.0))
            material["emissiveFactor"] = (radiance / strength).tolist()
            if strength > 1:
                extensions[STRENGTH] = {"emissiveStrength": strength}
        if extensions:
            material["extensions"] = extensions
            self.used |= set(extensions)
        self.materials.append({**material, "pbrMetallicRoughness": metal})
        return len(self.materials) - 1

    def _through(self, piece: Piece) -> tuple[np.ndarray, dict]:
        """The base colour, and the extensions by which readers find a pane's reflectance and transmittances.

        They take what is not transmitted of the colour as reflectance, and share both with the diffuse transmission.
        """
        reflectance, diffused = _three(piece.reflectance), _three(piece.diffuse)
        most = float(diffused.max())
        if not piece.transmittance and not most:
            return reflectance, {}
        passed, mean = piece.transmittance / NOT_MIRRORED, float(luminance_weights() @ reflectance)
        share = passed * (1 - most) / (mean + passed) if passed else 0.0
        rest = 1 - share - most
        colour = reflectance / rest if reflectance.any() else np.full(3, passed / (1 - most))
        extensions = {TRANSMISSION: {"transmissionFactor": share}} if share else {}
        if most:
            factors = {"diffuseTransmissionFactor": most / (1 - share)}
            extensions[DIFFUSION] = factors | {"diffuseTransmissionColorFactor": (diffused / most).tolist()}
        if float(luminance_weights() @ np.minimum(colour, 1.0)) * share * NOT_MIRRORED < piece.transmittance * (1 - 1e-9):
            self.told.add("panes that let more light through than the format can hold become darker", [piece.name])
        return colour, extensions

    def _texture(self, what: str, number: int, coordinates: int) -> tuple[dict, float]:
        """The reference to an image, and what its values are divided by to lie in [0, 1]."""
        if (what, number) not in self.known:
            paint: Paint = getattr(self.scene, f"{what}_paint")
            image = np.asarray(paint.images[number], np.float64)
            scale = max(float(image.max()), 1.0)
            codes = np.round(srgb(image / scale) * 255).astype(np.uint8)
            if np.abs(decode_srgb(codes / 255) - image / scale).max() > ROUNDED:
                self.told.add("images are rounded to 8 bits", [f"image {number} of {what}"])
            view = self.buffer.view(np.frombuffer(_png(codes), np.uint8))
            self.images.append({"bufferView": view, "mimeType": "image/png"})
            sampler = paint.sampler(number)
            kinds = {"wrapS": CODES[sampler.wrap[0]], "wrapT": CODES[sampler.wrap[1]], "magFilter": CODES[sampler.filter]}
            self.samplers.append(kinds)
            self.textures.append({"source": len(self.images) - 1, "sampler": len(self.samplers) - 1})
            self.known[what, number] = len(self.textures) - 1, scale
        index, scale = self.known[what, number]
        return {"index": index, "texCoord": coordinates}, scale


def _png(codes: np.ndarray) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(codes[..., 0] if codes.shape[2] == 1 else codes).save(file, "PNG")
    return file.getvalue()


def _three(values: np.ndarray) -> np.ndarray:
    return np.broadcast_to(values, (3,)).astype(np.float64)
