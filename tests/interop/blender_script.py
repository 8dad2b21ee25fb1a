"""Run by a Python that has ``bpy``: imports files with Blender and says what became of each, as JSON.

``python blender_script.py JOBS RESULTS``: JOBS is a JSON list of paths, RESULTS a list with one entry a file: an error, or
``{"object|material": record}``.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np
from shader_values import Points, value

POINTS = 5000  # in a triangle


def _import(path: str) -> None:
    suffix = Path(path).suffix
    if suffix in (".glb", ".gltf"):
        bpy.ops.import_scene.gltf(filepath=path, merge_vertices=False, import_shading="FLAT")
    elif suffix == ".obj":
        bpy.ops.wm.obj_import(filepath=path, forward_axis="Y", up_axis="Z", use_split_objects=True, use_split_groups=True)
    elif suffix == ".ply":
        bpy.ops.wm.ply_import(filepath=path, forward_axis="Y", up_axis="Z")
    else:
        bpy.ops.wm.stl_import(filepath=path, forward_axis="Y", up_axis="Z")


def _records(suffix: str) -> dict:
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    collected: dict[str, list] = {}
    for instance in graph.object_instances:
        thing = instance.object
        if thing.type != "MESH" or not (instance.show_self or instance.is_instance):
            continue
        mesh = thing.to_mesh()
        mesh.calc_loop_triangles()
        matrix = np.array(instance.matrix_world)
        for slot in sorted({t.material_index for t in mesh.loop_triangles}):
            triangles = [t for t in mesh.loop_triangles if t.material_index == slot]
            material = thing.material_slots[slot].material if slot < len(thing.material_slots) else None
            # instances of the extension hang below the node that has them, whose name write_gltf begins with "thing"
            owner = thing.parent.name if thing.parent and thing.parent.name.startswith("thing") else thing.name
            key = f"{owner}|{material.name if material else ''}"
            collected.setdefault(key, []).append(_part(mesh, triangles, matrix, material, suffix))
        thing.to_mesh_clear()
    return {key: _joined(parts) for key, parts in collected.items()}


def _joined(parts: list[dict]) -> dict:
    result = dict(parts[0])
    for key in ("triangles", "reflectance", "radiance"):
        result[key] = [value for part in parts for value in part[key]]
    return result


def _part(mesh, triangles, matrix, material, suffix: str) -> dict:
    corners = np.array([[mesh.vertices[v].co for v in t.vertices] for t in triangles], float)
    corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
    if np.linalg.det(matrix[:3, :3]) < 0:
        corners = corners[:, ::-1]  # a mirrored object keeps its front
    if suffix in (".glb", ".gltf"):
        corners = np.stack([corners[..., 0], corners[..., 2], -corners[..., 1]], axis=-1)  # back to y up
    points = Points(mesh, triangles, POINTS)
    shader = _principled(material)
    painted = bool(mesh.color_attributes) and material is None
    color = points.attribute(mesh.color_attributes[0].name) if painted else value(shader, "Base Color", points)
    emitted = value(shader, "Emission Color", points) * value(shader, "Emission Strength", points)
    return {
        "triangles": corners.tolist(),
        "reflectance": points.means(color).tolist(),
        "radiance": points.means(emitted).tolist(),
        "sides": 1 if material and material.use_backface_culling else 2,
        "material": bool(material) or painted,
    }


def _principled(material):
    if material is None or material.node_tree is None:
        return None
    return next((node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED"), None)


def main(jobs: str, results: str) -> None:
    found = []
    for path in json.loads(Path(jobs).read_text()):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        try:
            _import(path)
            found.append(_records(Path(path).suffix))
        except Exception as error:  # of any class: it is the answer
            found.append({"error": f"{type(error).__name__}: {error}"})
    Path(results).write_text(json.dumps(found))


main(*sys.argv[-2:])
