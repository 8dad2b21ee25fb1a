"""Referee: Mitsuba's path tracer. Irradiance of a patch is the mean over its points of light sampled directly, and of what paths
that leave with a cosine distribution bring back; their depth is not limited, and their roulette has no bias."""

from dataclasses import replace

import numpy as np

import radiosity as rd

from .equations import both
from .points import on_patches
from .runs import SEEDS
from .scenes import parallel_scenes

CHUNK = 1 << 20
WIDE = 1000.0
OFFSET = 1e-5  # of the scene's extent, in front of the patch
APART = 4e-6  # likewise, between the sheets that stand for the two sides of a face


def irradiance(patches: rd.Patches, paths: int, batches: int = SEEDS, seed: int = 99) -> np.ndarray:
    """(batches, n_patches, n_bands) independent estimates from ``paths`` points on each patch."""
    from radiosity.device.backend import choose, entered, upload

    device = choose("cpu")
    patches = _wide(patches)
    types, n = device.types, len(patches)
    generator = np.random.Generator(np.random.Philox(seed))
    normal = np.repeat(patches.normal, paths, axis=0)
    lift = OFFSET * float(np.ptp(patches.scene.bounds, axis=0).max())
    results = np.zeros((batches, n, patches.scene.n_bands))
    with entered(device) as mi:
        import drjit as dr

        world = world_of(mi, patches.scene, upload, types)
        integrator = mi.load_dict({"type": "path", "max_depth": -1, "rr_depth": 16})
        for batch in range(batches):
            point = on_patches(patches, paths, generator).reshape(-1, 3) + lift * normal
            found = np.zeros((len(point), 3))
            for at in range(0, len(point), CHUNK):
                rows = slice(at, at + CHUNK)
                origin, front = (
                    types.Array3f(*(upload(types.Float, c.astype(np.float32)) for c in a[rows].T)) for a in (point, normal)
                )
                sampler = mi.load_dict({"type": "independent"})
                sampler.seed(seed * 1_000_003 + batch * 1009 + at // CHUNK, len(point[rows]))
                value = _arriving(mi, dr, world, integrator, sampler, mi.Point3f(origin), mi.Normal3f(front))
                found[rows] = np.array(value).T
            results[batch] = found.reshape(n, paths, 3).mean(axis=1)[:, : patches.scene.n_bands]
    return results


def _wide(patches: rd.Patches) -> rd.Patches:
    """The same, centred and `WIDE` metres wide: Mitsuba's paths go on some (1 + |p|) x 1e-4 from where they are, whatever the
    unit of p, which in a scene of half a metre is enough to shine under a box. Irradiance does not depend on the scale."""
    scene = patches.scene
    low, high = scene.bounds
    vertices = (scene.vertices - (low + high) / 2) * (WIDE / (high - low).max())
    return replace(patches, scene=replace(scene, vertices=vertices))


def _arriving(mi, dr, world, integrator, sampler, origin, normal):
    """One estimate of irradiance at each point.

    Light that comes straight from emitters is sampled both ways and weighted by the balance heuristic (E. Veach and L. J. Guibas,
    "Optimally combining sampling techniques", SIGGRAPH 1995): emitters that meet the patch at an edge would give sampled emitters
    alone an infinite variance.
    """
    here = dr.zeros(mi.SurfaceInteraction3f, dr.width(origin))
    here.p, here.n = origin, normal
    here.sh_frame = mi.Frame3f(normal)
    light, weight = world.sample_emitter_direction(here, sampler.next_2d(), True)
    cosine = dr.maximum(dr.dot(light.d, normal), 0)
    direct = weight * cosine * (light.pdf / (light.pdf + cosine / dr.pi))
    local = mi.warp.square_to_cosine_hemisphere(sampler.next_2d())
    ray = mi.RayDifferential3f(origin, here.sh_frame.to_world(local))
    radiance, _, _ = integrator.sample(world, sampler, ray)
    met = world.ray_intersect(ray)
    emitter = met.emitter(world)
    emitted = dr.select(met.is_valid(), emitter.eval(met), 0)
    chance = world.pdf_emitter_direction(here, mi.DirectionSample3f(world, met, here), emitter != None)  # noqa: E711
    own = local.z / dr.pi
    straight = dr.select(emitter != None, emitted * (own / (own + chance)), 0)  # noqa: E711
    return dr.select(light.pdf > 0, direct, 0) + dr.pi * (radiance - emitted + straight)


def world_of(mi, scene: rd.Scene, upload, types, *, merged: bool = False):
    """Return a scene of Mitsuba's: a sheet for each radiating or absorbing side, and one for both sides of a clear pane.

    Args:
        merged: sides of equal reflectance and emission are one mesh, for scenes of many faces.
    """
    apart = APART * float(np.ptp(scene.bounds, axis=0).max())
    parts: dict = {"type": "scene"}
    together: dict = {}
    for face in range(scene.n_faces):
        corners = scene.vertices[scene.faces[face][: 4 if scene.is_quad[face] else 3]]
        if scene.panes[face]:
            surface = _pane(scene, face)
            together.setdefault(str(surface) if merged else f"pane{face}", ([], surface, np.zeros(1)))[0].append(corners)
            continue
        sides = [("front", corners, scene.reflectance[face], scene.emission[face])]
        if scene.back[face] == rd.Back.RADIATES:  # a sheet for each side, since an emitter has one
            back = corners[::-1] - apart * scene.normal[face]
            sides.insert(0, ("back", back, scene.back_reflectance[face], scene.back_emission[face]))
        for side, points, reflectance, emission in sides:
            key = (reflectance.tobytes(), emission.tobytes()) if merged else f"{side}{face}"
            together.setdefault(key, ([], _diffuse(reflectance), emission))[0].append(points)
    for number, (key, (polygons, surface, emission)) in enumerate(together.items()):
        name = f"side{number}" if merged else key
        parts[name] = _sheet(mi, polygons, surface, emission, upload, types)
    return mi.load_dict(parts)


def _diffuse(reflectance: np.ndarray) -> dict:
    """Return a one-sided surface, black from behind."""
    return {"type": "diffuse", "reflectance": {"type": "rgb", "value": np.broadcast_to(reflectance, 3).tolist()}}


def _pane(scene: rd.Scene, face: int) -> dict:
    """Return the surface of a clear pane, which passes the same share of light at all angles.

    Raises:
        ValueError: the pane is glass, whose share depends on the angle, or it emits: Mitsuba's scene would be another one.
    """
    radiates, through = scene.back[face] == rd.Back.RADIATES, scene.transmittance
    emits = scene.emission[face].any() or (radiates and scene.back_emission[face].any())
    if through is None or emits or (scene.refractive_index is not None and scene.refractive_index[face] > 0):
        name = scene.names[scene.surface[face]]
        raise ValueError(
            f"{scene.source}, surface '{name}', face {face}: it is glass by angle, or emits; give a pane that does neither"
        )
    solid = 1 - through[face]  # of its area; what the pane reflects comes from there
    front, back = scene.reflectance[face] / solid, scene.back_reflectance[face] / solid * radiates
    both = {"type": "twosided", "front": _diffuse(front), "back": _diffuse(back)}
    return {"type": "mask", "opacity": float(solid), "solid": both}


def _sheet(mi, polygons: list, surface: dict, emission: np.ndarray, upload, types):
    """Return a mesh. ``polygons`` hold the corners of triangles and quadrilaterals, (3 or 4, 3) each."""
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(surface)
    if emission.any():
        radiance = {"type": "rgb", "value": np.broadcast_to(emission / np.pi, 3).tolist()}
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    points = np.concatenate(polygons)
    first = np.cumsum([0, *(len(polygon) for polygon in polygons[:-1])])
    fans = [at + np.array([[0, 1, 2], [0, 2, 3]][: len(polygon) - 2]) for at, polygon in zip(first, polygons, strict=True)]
    triangles = np.concatenate(fans)
    mesh = mi.Mesh("sheet", len(points), len(triangles), props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = upload(types.Float, points.ravel().astype(np.float32))
    parameters["faces"] = upload(types.UInt32, triangles.astype(np.uint32).ravel())
    parameters.update()
    return mesh


def run(quick: bool):
    """Patchwise comparisons of each scene: of both equations."""
    rays, paths = (100_000, 64) if quick else (1_000_000, 512)
    for name, patches in parallel_scenes():
        theirs = irradiance(patches, paths)
        yield from both(name, patches, rays * SEEDS, theirs)
