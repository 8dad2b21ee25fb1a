"""Random glTF materials and textures."""

import base64
from pathlib import Path

from .draw import Draw
from .gltf_buffer import Buffer
from .images import save_png

REPEAT, MIRROR, CLAMP = 10497, 33648, 33071
LINEAR, NEAREST = 9729, 9728


def add_materials(draw: Draw, tree: dict, buffer: Buffer, folder: Path, seed: int) -> int:
    """Adds materials to the tree; how many."""
    draw.has("second coordinates", 0.25)
    tree["materials"] = [_material(draw, tree, buffer, folder, f"{seed}_{number}", number) for number in range(3)]
    return len(tree["materials"])


def _material(draw: Draw, tree: dict, buffer: Buffer, folder: Path, stem: str, number: int) -> dict:
    metal: dict = {"baseColorFactor": [*draw.color(), 1.0], "metallicFactor": 0.0, "roughnessFactor": 1.0}
    material: dict = {"name": f"mat{number}", "pbrMetallicRoughness": metal}
    if draw.has("base textures", 0.25):
        metal["baseColorTexture"] = _texture(draw, tree, buffer, folder, f"{stem}b")
        if draw.random() < 0.4:
            del metal["baseColorFactor"]
    elif "no base colour" in draw.features and number == 0 and "vertex colours" not in draw.features:
        del metal["baseColorFactor"]
    if draw.has("double-sided", 0.4):
        material["doubleSided"] = True
    if draw.has("emission", 0.4):
        material["emissiveFactor"] = [round(float(v), 3) for v in draw.uniform(0, 1, 3)]
        if draw.has("emissive strength", 0.5):
            strength = round(float(draw.uniform(0.5, 20)), 3)
            material["extensions"] = {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}
            buffer.uses("KHR_materials_emissive_strength")
        if draw.has("emission textures", 0.25):
            material["emissiveTexture"] = _texture(draw, tree, buffer, folder, f"{stem}e")
    if draw.has("transparency", 0.1):
        material["alphaMode"] = draw.one("BLEND", "MASK")
    return material


def _texture(draw: Draw, tree: dict, buffer: Buffer, folder: Path, stem: str) -> dict:
    path = folder / f"{stem}.png"
    save_png(path, draw.image())
    kind = draw.one("view", "file", "data")
    draw.features.add(f"image in a {kind}")
    image = {
        "view": lambda: {"bufferView": buffer.view(path.read_bytes()), "mimeType": "image/png"},
        "file": lambda: {"uri": path.name},
        "data": lambda: {"uri": "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode()},
    }[kind]()
    tree.setdefault("images", []).append(image)
    texture = {"source": len(tree["images"]) - 1}
    if draw.has("samplers", 0.5):
        sampler = {"magFilter": draw.one(LINEAR, LINEAR, NEAREST)}
        sampler |= {key: draw.one(REPEAT, MIRROR, CLAMP) for key in ("wrapS", "wrapT") if draw.random() < 0.7}
        draw.features |= {"nearest filter"} if sampler["magFilter"] == NEAREST else set()
        wraps = {sampler.get(key, REPEAT) for key in ("wrapS", "wrapT")}
        draw.features |= {"wraps"} if wraps != {REPEAT} else set()
        draw.features |= {"unequal wraps"} if len(wraps) > 1 else set()
        tree.setdefault("samplers", []).append(sampler)
        texture["sampler"] = len(tree["samplers"]) - 1
    tree.setdefault("textures", []).append(texture)
    use: dict = {"index": len(tree["textures"]) - 1}
    if "second coordinates" in draw.features and draw.random() < 0.6:
        use["texCoord"] = 1
    if draw.has("texture transform", 0.3):
        move = {"offset": draw.uniform(-1, 1, 2).round(3).tolist(), "scale": draw.uniform(0.5, 2, 2).round(3).tolist()}
        if draw.random() < 0.6:
            move["rotation"] = round(float(draw.uniform(-3, 3)), 3)
        if "second coordinates" in draw.features and draw.random() < 0.4:
            move["texCoord"] = 1 - use.get("texCoord", 0)
            draw.features.add("coordinates of the transform")
        use["extensions"] = {"KHR_texture_transform": move}
        buffer.uses("KHR_texture_transform")
    return use
