"""The extensions of a glTF file: those that are read, those that change nothing here, and the rest."""

import numpy as np

from ....errors import shown
from ...assemble import warn
from .accessor import accessor
from .file import COMPRESSED, UNPACK, GltfFile
from .nodes import Node, composed

READ = (
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_lights_punctual",
    "EXT_texture_webp",
    "KHR_node_visibility",
    "EXT_mesh_gpu_instancing",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_diffuse_transmission",
)
# factors beside which a material is not diffuse, and their defaults; what only shapes their light is left out in silence
GLOSSY = {
    "KHR_materials_transmission": ("transmissionFactor", 0.0),
    "KHR_materials_clearcoat": ("clearcoatFactor", 0.0),
    "KHR_materials_sheen": ("sheenColorFactor", (0.0, 0.0, 0.0)),
    "KHR_materials_iridescence": ("iridescenceFactor", 0.0),
}
SILENT = (
    "KHR_materials_specular",
    "KHR_materials_ior",
    "KHR_materials_volume",
    "KHR_materials_dispersion",
    "KHR_materials_anisotropy",
    "KHR_xmp_json_ld",
    "KHR_animation_pointer",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_interactivity",
)
INSTANCED = {"TRANSLATION": 3, "ROTATION": 4, "SCALE": 3}
MOST_INSTANCED = 20_000_000  # faces or vertices of one object


def check_required(file: GltfFile) -> None:
    """Refuse files that cannot be understood without an extension that is not read.

    Raises:
        SceneError: it is required.
    """
    required = [str(name) for name in file.items(file.tree, "extensionsRequired")]
    if packed := [name for name in required if name in COMPRESSED]:
        raise file.fail(f"is compressed with {shown(packed)}, which is not read; {UNPACK}")
    known = (*READ, *GLOSSY, *SILENT)
    unknown = [name for name in required if name not in known and not name.startswith("KHR_materials_")]
    if unknown:
        raise file.fail(f"needs the extension {shown(unknown)}, which is not read; export it without this extension")


def warn_of_unread(file: GltfFile) -> None:
    """Tell once of extensions that are not read, and of motion."""
    used = [str(name) for name in file.items(file.tree, "extensionsUsed")]
    known = (*READ, *GLOSSY, *SILENT, *COMPRESSED)
    if unread := [name for name in used if name not in known]:
        warn(f"{file.path}: extensions that are not read: {shown(dict.fromkeys(unread))}")
    if "KHR_materials_variants" in file.tree.get("extensions", {}):
        variants = file.items(file.dictionary(file.tree["extensions"]["KHR_materials_variants"], "variants"), "variants")
        names = [str(one.get("name")) if isinstance(one, dict) else str(one) for one in variants]
        warn(f"{file.path}: variants of materials are left out, the material of each primitive itself is taken: {shown(names)}")
    if animations := file.items(file.tree, "animations"):
        names = [one.get("name") or f"animation {i}" for i, one in enumerate(animations) if isinstance(one, dict)]
        warn(f"{file.path}: animations are left out, all stands as its nodes say: {shown(names)}")


def instances(file: GltfFile, node: Node, size: int) -> np.ndarray | None:
    """Return transforms of the copies of a node's mesh within the node, (k, 4, 4), or None (EXT_mesh_gpu_instancing).

    Args:
        size: the number of faces or of vertices of the mesh, whichever is larger.

    Raises:
        SceneError: attributes do not fit each other, or there are more faces than can be meant.
    """
    info = node.extension(file, "EXT_mesh_gpu_instancing")
    if info is None:
        return None
    what, given = f"the instances of '{node.name}'", {}
    attributes = file.dictionary(info.get("attributes", {}), f"attributes of {what}")
    held = {key: attributes[key] for key in INSTANCED if key in attributes}
    counts = {key: file.whole(file.item("accessors", index), "count", what) for key, index in held.items()}
    if len(set(counts.values())) != 1:
        raise file.fail(f"the attributes of {what} have {counts or 'no'} entries; expected equal counts of {shown(INSTANCED)}")
    count = next(iter(counts.values()))
    if count * max(size, 1) > MOST_INSTANCED:
        raise file.fail(f"{what} are {count} of {size} faces or vertices; at most {MOST_INSTANCED} are read: split the scene")
    for key, index in held.items():
        given[key] = accessor(file, index).astype(np.float64)
        if given[key].shape[1] != INSTANCED[key]:
            raise file.fail(f"{key} of {what} has {given[key].shape[1]} numbers each; expected {INSTANCED[key]}")
    rotation = given.get("ROTATION", np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)))
    if not rotation.any(axis=1).all():
        raise file.fail(f"ROTATION of {what} holds a zero; expected unit quaternions")
    return composed(given.get("TRANSLATION", np.zeros((count, 3))), rotation, given.get("SCALE", np.ones((count, 3))))
