"""Bakes a lightmap in Blender's Cycles, in a process of its own: the other half of ``make bench-lightmap``.

python benchmarks/lightmap_blender.py ROOM.npz OUT.npz SAMPLES SEED, by a Python that has bpy. ROOM.npz holds corners (m, 3, 3) of
triangles, their places on the page uv (m, 3, 2) in [0, 1], reflectance and emission (m, n_bands), the page's width and height.
OUT.npz gets values (height, width, 3), row 0 at the top, and CPU seconds of the bake.
"""

import os
import sys

import bpy
import numpy as np

ROOM, OUT, SAMPLES, SEED = sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])
NO_LIMIT = 1024  # bounces


def material(name: str, reflectance, emission):
    """Return a diffuse material that emits from its front alone."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    surface = nodes.new("ShaderNodeBsdfDiffuse")
    surface.inputs["Color"].default_value = (*np.broadcast_to(reflectance, 3), 1)
    found = surface.outputs[0]
    if np.any(emission):
        light, both, side, facing = (
            nodes.new(kind)
            for kind in ("ShaderNodeEmission", "ShaderNodeAddShader", "ShaderNodeMixShader", "ShaderNodeNewGeometry")
        )
        light.inputs["Color"].default_value = (*np.broadcast_to(emission / np.pi, 3), 1)
        links.new(surface.outputs[0], both.inputs[0])
        links.new(light.outputs[0], both.inputs[1])
        links.new(facing.outputs["Backfacing"], side.inputs[0])
        links.new(both.outputs[0], side.inputs[1])
        links.new(surface.outputs[0], side.inputs[2])
        found = side.outputs[0]
    links.new(found, nodes.new("ShaderNodeOutputMaterial").inputs[0])
    return made


def main() -> None:
    """Bake, and write the values."""
    room = np.load(ROOM)
    corners, uv, size = room["corners"], room["uv"], (int(room["width"]), int(room["height"]))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("room")
    mesh.from_pydata(corners.reshape(-1, 3).tolist(), [], np.arange(3 * len(corners)).reshape(-1, 3).tolist())
    places = uv * [1, -1] + [0, 1]  # Blender's v goes up
    mesh.uv_layers.new(name="map").data.foreach_set("uv", places.astype(np.float32).ravel())
    image = bpy.data.images.new("map", *size, float_buffer=True)
    values = np.concatenate([room["reflectance"], room["emission"]], axis=1)
    kinds, kind = np.unique(values, axis=0, return_inverse=True)
    n = values.shape[1] // 2
    for number, row in enumerate(kinds):
        made = material(f"m{number}", row[:n], row[n:])
        target = made.node_tree.nodes.new("ShaderNodeTexImage")
        target.image = image
        made.node_tree.nodes.active = target
        mesh.materials.append(made)
    mesh.polygons.foreach_set("material_index", kind.ravel().astype(np.int32))
    mesh.update()
    thing = bpy.data.objects.new("room", mesh)
    scene = bpy.context.scene
    scene.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", SAMPLES, SEED
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = NO_LIMIT
    cycles.sample_clamp_indirect = cycles.sample_clamp_direct = cycles.light_sampling_threshold = 0
    before = os.times()
    bpy.ops.object.bake(type="DIFFUSE", pass_filter={"DIRECT", "INDIRECT"}, margin=0, use_clear=True)
    after = os.times()
    pixels = np.empty(size[0] * size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    seconds = after.user + after.system - before.user - before.system
    np.savez(OUT, values=pixels.reshape(size[1], size[0], 4)[::-1, :, :3], seconds=seconds)


if __name__ == "__main__":
    main()
