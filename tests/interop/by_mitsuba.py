"""Mitsuba as the second reader: of its own scenes, and of the geometry of OBJ and PLY files."""

import numpy as np
from mitsuba_rays import mitsuba_hits, our_hits, random_rays

from radiosity.device import backend as device

from .compare import Difference
from .images import spots, square
from .record import Reading, Refused, Surface, surface

POINTS = 800  # in each triangle of a mesh whose texture varies; a round shape has four times as many
RAYS = 40


def mesh(path) -> Reading:
    """One surface of the whole file."""
    try:
        shape = _mitsuba().load_dict({"type": path.suffix[1:], "filename": str(path), "face_normals": True})
    except RuntimeError as error:
        raise Refused(str(error)) from None
    return {"all": surface(_triangles(shape))}


def scene(path) -> Reading:
    """All shapes but instances, which Mitsuba hides; rays find those."""
    mitsuba = _mitsuba()
    try:
        with device.bitmaps():
            loaded = mitsuba.load_file(str(path), optimize=False)
    except RuntimeError as error:
        raise Refused(str(error)) from None
    return {shape.id(): _surface(mitsuba, shape) for shape in loaded.shapes() if not str(shape).startswith("Instance")}


def rays(path, ours, features: set[str]) -> list[Difference]:
    """What random rays meet: distance, side and reflectance. Round shapes are flat faces to us, so their rays differ."""
    if "round shapes" in features:
        return []
    origins, directions = random_rays(ours.bounds, RAYS, 5)
    theirs, mine = mitsuba_hits(path, origins, directions), our_hits(ours, origins, directions)
    both = np.isfinite(theirs[0]) & np.isfinite(mine[0])
    alike = np.isclose(theirs[0], mine[0], rtol=1e-4) | (np.isinf(theirs[0]) & np.isinf(mine[0]))
    found = [] if alike.all() else [Difference("*", "distances of rays", mine[0][~alike], theirs[0][~alike])]
    side = both & alike & (theirs[1] != mine[1])
    return found + ([Difference("*", "sides of rays", mine[1][side], theirs[1][side])] if side.any() else [])


def _surface(mitsuba, shape) -> Surface:
    points = _mesh_points if shape.is_mesh() else _round_points
    bsdf, lamp = shape.bsdf(), shape.emitter() if shape.is_emitter() else None
    area, box = float(shape.surface_area()), shape.bbox()

    def mean(of, varied: bool) -> np.ndarray:
        rows = [(np.array(of(si), float), weight) for si, weight in points(mitsuba, shape, varied)]
        return np.average([value for value, _ in rows], axis=0, weights=[weight for _, weight in rows])

    def back(si) -> float:
        si.wi = [0, 0, -1]
        return float(np.max(np.array(bsdf.eval(mitsuba.BSDFContext(), si, [0, 0, -1]))))

    reflectance = mean(bsdf.eval_diffuse_reflectance, _varies(bsdf))
    return Surface(
        area=area,
        bounds=np.array([box.min, box.max], float),
        vector=area * mean(lambda si: si.sh_frame.n, False) if shape.is_mesh() else None,
        sides=2 if mean(back, False) > 0 else 1 if reflectance.any() else None,  # of black ones both sides are alike
        reflectance=reflectance,
        power=np.pi * area * mean(lamp.eval, _varies(lamp)) if lamp else np.zeros(3),
        sampled=_varies(bsdf) or (lamp is not None and _varies(lamp)),
    )


def _varies(thing) -> bool:
    return any(word in str(thing) for word in ("BitmapTexture", "Checkerboard", "MeshAttribute"))


def _mesh_points(mitsuba, shape, varied: bool):
    """Points in all triangles, with their weights."""
    ray, hit = mitsuba.Ray3f([0, 0, 0], [0, 0, 1]), mitsuba.PreliminaryIntersection3f()
    hit.shape, hit.t = shape, 1.0
    at = spots(POINTS) if varied else np.full((1, 3), 1 / 3)
    for number, corners in enumerate(_triangles(shape)):
        hit.prim_index = number
        area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]))
        for weights in at:
            hit.prim_uv = weights[1:]
            si = shape.compute_surface_interaction(ray, hit, mitsuba.RayFlags.All)
            si.wi = [0, 0, 1]
            yield si, area


def _round_points(mitsuba, shape, varied: bool):
    """Points that fill a shape evenly."""
    for at in square(4 * POINTS if varied else 1):
        si = mitsuba.SurfaceInteraction3f(shape.sample_position(0, at), mitsuba.Color0f())
        si.wi = [0, 0, 1]
        yield si, 1.0


def _triangles(shape) -> np.ndarray:
    faces = np.array(shape.faces_buffer()).reshape(-1, 3)
    return np.array(shape.vertex_positions_buffer(), float).reshape(-1, 3)[faces]


def _mitsuba():
    import mitsuba

    if mitsuba.variant() != "scalar_rgb":  # each change is slow, and leaves something behind
        mitsuba.set_variant("scalar_rgb")
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    return mitsuba
