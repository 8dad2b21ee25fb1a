"""Mitsuba as the second reader: of its own scenes, and of the geometry of OBJ and PLY files."""

import numpy as np
from mitsuba_rays import mitsuba_hits, our_hits, random_rays

from .compare import Difference
from .images import spots
from .record import Reading, Refused, Surface, surface

ALONG = 60  # points along both axes of a round shape, where a texture varies
POINTS = 1500  # and in each triangle of a mesh
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
    textured = any(word in str(shape) for word in ("BitmapTexture", "Checkerboard"))
    reflectances, radiances, weights, both = [], [], [], False
    for sample, weight in _points(mitsuba, shape, textured):
        si = mitsuba.SurfaceInteraction3f(sample, mitsuba.Color0f())
        si.wi = [0, 0, 1]
        weights.append(weight)
        reflectances.append(np.array(shape.bsdf().eval_diffuse_reflectance(si), float))
        radiances.append(np.array(shape.emitter().eval(si), float) if shape.is_emitter() else np.zeros(3))
        si.wi = [0, 0, -1]
        both |= bool(np.any(np.array(shape.bsdf().eval(mitsuba.BSDFContext(), si, [0, 0, -1])) > 0))
    area, box = float(shape.surface_area()), shape.bbox()
    return Surface(
        area=area,
        bounds=np.array([box.min, box.max], float),
        sides=2 if both else 1,
        reflectance=np.average(reflectances, axis=0, weights=weights),
        power=np.pi * area * np.average(radiances, axis=0, weights=weights),
        sampled=textured,
    )


def _points(mitsuba, shape, textured: bool):
    """Points of a shape with their weights: in all triangles of a mesh, equal steps of a round shape's own."""
    if not textured or not shape.is_mesh():
        steps = (np.arange(ALONG if textured else 1) + 0.5) / (ALONG if textured else 1)
        yield from ((shape.sample_position(0, [u, v]), 1.0) for u in steps for v in steps)
        return
    faces = np.array(shape.faces_buffer()).reshape(-1, 3)
    uv = np.array(shape.vertex_texcoords_buffer(), float).reshape(-1, 2)[faces]
    sample = shape.sample_position(0, [0.5, 0.5])  # only its texture coordinates count
    for corners, coordinates in zip(_triangles(shape), uv, strict=True):
        area = np.linalg.norm(np.cross(corners[1] - corners[0], corners[2] - corners[0]))
        for at in spots(POINTS) @ coordinates:
            sample.uv = at
            yield sample, area


def _triangles(shape) -> np.ndarray:
    faces = np.array(shape.faces_buffer()).reshape(-1, 3)
    return np.array(shape.vertex_positions_buffer(), float).reshape(-1, 3)[faces]


def _mitsuba():
    import mitsuba

    mitsuba.set_variant("scalar_rgb")
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    return mitsuba
