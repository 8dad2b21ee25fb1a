"""trimesh as the second reader of PLY, OBJ, STL and glTF."""

import logging

import numpy as np

from .images import linear, means
from .record import Reading, Refused, surface

logging.getLogger("trimesh").setLevel(logging.CRITICAL)


def ply(path) -> Reading:
    import trimesh

    try:
        mesh = trimesh.load(path, process=False)
    except Exception as error:  # of many classes
        raise Refused(f"{type(error).__name__}: {error}") from None
    if not hasattr(mesh, "faces"):
        raise Refused(f"a {type(mesh).__name__} without faces")
    named = b"TextureFile" in path.read_bytes()
    if not named and mesh.visual.kind == "texture":
        return {path.stem: surface(mesh.triangles)}  # coordinates alone: it takes an image of its own, and no colours
    return {path.stem: surface(mesh.triangles, reflectance=_painted(mesh), sampled=named)}


def stl(path) -> Reading:
    """All solids as one surface: it renames those without a name."""
    import trimesh

    try:
        scene = trimesh.load_scene(path, process=False)
    except Exception as error:
        raise Refused(f"{type(error).__name__}: {error}") from None
    return {name: surface(mesh.triangles) for name, mesh in scene.geometry.items()}


def obj(path) -> Reading:
    import trimesh

    try:
        scene = trimesh.load_scene(path, process=False, split_groups=True)
    except Exception as error:
        raise Refused(f"{type(error).__name__}: {error}") from None
    return {
        name: surface(mesh.triangles, reflectance=_simple(mesh, getattr(mesh.visual, "material", None)), sampled=True)
        for name, mesh in scene.geometry.items()
    }


def gltf(path) -> Reading:
    """All nodes as one surface; colours where no texture and no vertex colour has a part in them."""
    import trimesh

    try:
        scene = trimesh.load_scene(path, process=False)
    except Exception as error:
        raise Refused(f"{type(error).__name__}: {error}") from None
    result = {}
    for node in scene.graph.nodes_geometry:
        matrix, geometry = scene.graph[node]
        mesh = scene.geometry[geometry]
        if not hasattr(mesh, "faces"):
            continue  # points and lines
        corners = mesh.triangles @ matrix[:3, :3].T + matrix[:3, 3]
        if np.linalg.det(matrix[:3, :3]) < 0:
            corners = corners[:, ::-1]  # a mirrored node keeps its front
        result[node] = surface(corners, **_physical(getattr(mesh.visual, "material", None), mesh), sampled=True)
    return result


def _physical(material, mesh) -> dict:
    """Base colour, to 1/255, and emission of a glTF material."""
    if material is None or not hasattr(material, "emissiveFactor"):
        return {}
    plain = material.baseColorTexture is None and "color" not in mesh.visual.vertex_attributes
    factor = [255] * 3 if material.baseColorFactor is None else material.baseColorFactor[:3]
    sides = 2 if material.doubleSided else 1
    emitted = np.zeros(3) if material.emissiveFactor is None else np.asarray(material.emissiveFactor, float)
    return {
        "reflectance": np.asarray(factor) / 255 if plain else None,
        "exitance": np.pi * sides * emitted if material.emissiveTexture is None or not emitted.any() else None,
    }


def _simple(mesh, material) -> np.ndarray | None:
    """(m, 3) mean of Kd, to 1/255, times the texture."""
    if material is None or not hasattr(material, "diffuse"):
        return _painted(mesh)
    if material.name == "material_0":
        return None  # its default for a file without materials, which has coordinates but no colours
    diffuse = np.asarray(material.diffuse[:3]) / 255
    if material.image is None:
        return np.broadcast_to(diffuse, (len(mesh.faces), 3))
    return diffuse * means(mesh.visual.uv[mesh.faces], linear(np.asarray(material.image.convert("RGB")) / 255))


def _painted(mesh) -> np.ndarray | None:
    """(m, 3) mean linear colours of vertices or faces; None where the file gives none."""
    kind = getattr(mesh.visual, "kind", None)
    if kind == "vertex":
        colors = linear(mesh.visual.vertex_colors[:, :3] / 255)[mesh.faces]
        return colors.mean(axis=1)
    if kind == "face":
        colors = linear(mesh.visual.face_colors[:, :3] / 255)
        return colors if len(colors) == len(mesh.faces) else np.full(3, np.nan)  # it does not repeat them where it cuts polygons
    image = getattr(getattr(mesh.visual, "material", None), "image", None)
    if kind == "texture" and image is not None and mesh.visual.uv is not None:
        return means(mesh.visual.uv[mesh.faces], linear(np.asarray(image.convert("RGB")) / 255))
    return None
