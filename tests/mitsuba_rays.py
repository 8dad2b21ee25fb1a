"""Rays into a scene that Mitsuba loaded, and the same rays into ours, for tests."""

from contextlib import contextmanager

import numpy as np

from radiosity.device import backend as device


def files(folder):
    """A cube as OBJ, PLY and serialized mesh, with and without normals: names by (plugin, has normals)."""
    points = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    normals = [(-1, 0, 0), (1, 0, 0), (0, -1, 0), (0, 1, 0), (0, 0, -1), (0, 0, 1)]
    corners = points[np.ravel(quads)]
    directions = np.repeat(normals, 4, axis=0).astype(float)
    triangles = np.array([(4 * i + a, 4 * i + b, 4 * i + c) for i in range(6) for a, b, c in ((0, 1, 2), (0, 2, 3))])
    names = {}
    for has in (False, True):
        for plugin, write in (("obj", obj_bytes), ("ply", ply_bytes), ("serialized", serialized_bytes)):
            names[plugin, has] = f"cube{int(has)}.{plugin}"
            (folder / names[plugin, has]).write_bytes(write(corners, directions if has else None, triangles))
    return names


def obj_bytes(points, normals, triangles):
    lines = ["v {} {} {}".format(*p) for p in points]
    lines += ["vn {} {} {}".format(*n) for n in ([] if normals is None else normals)]
    word = "{0}" if normals is None else "{0}//{0}"
    return "\n".join(lines + ["f " + " ".join(word.format(i + 1) for i in t) for t in triangles]).encode()


def ply_bytes(points, normals, triangles):
    names = ["x", "y", "z"] + ([] if normals is None else ["nx", "ny", "nz"])
    table = points if normals is None else np.hstack([points, normals])
    head = ["ply", "format ascii 1.0", f"element vertex {len(points)}", *(f"property float {n}" for n in names)]
    head += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header"]
    rows = [" ".join(map(str, row)) for row in table] + ["3 " + " ".join(map(str, t)) for t in triangles]
    return "\n".join(head + rows).encode() + b"\n"


def serialized_bytes(points, normals, triangles):
    import struct
    import zlib

    body = struct.pack("<I", 0x1000 | (normals is not None)) + b"cube\0" + struct.pack("<QQ", len(points), len(triangles))
    body += points.astype("<f4").tobytes() + (b"" if normals is None else normals.astype("<f4").tobytes())
    body += triangles.astype("<u4").tobytes()
    return struct.pack("<HH", 0x041C, 4) + zlib.compress(body) + struct.pack("<QI", 0, 1)


def random_rays(bounds, count, seed):
    """Origins around a box, towards points in it."""
    generator = np.random.Generator(np.random.Philox(seed))
    middle, half = bounds.mean(axis=0), np.ptp(bounds, axis=0).max() / 2 + 0.1
    away = generator.normal(size=(count, 3))
    origins = middle + 4 * half * away / np.linalg.norm(away, axis=1, keepdims=True)
    targets = bounds[0] + generator.random((count, 3)) * np.ptp(bounds, axis=0)
    directions = targets - origins
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


@contextmanager
def scalar_variant():
    """Mitsuba in the variant scalar_rgb; the one that was set before comes back. Each change loads modules of Mitsuba again:
    tests of a file that need it share one."""
    import mitsuba as mi

    before = mi.variant()
    if before != "scalar_rgb":
        mi.set_variant("scalar_rgb")
    try:
        yield mi
    finally:
        if before not in (None, "scalar_rgb"):
            mi.set_variant(before)


@contextmanager
def scalar_mitsuba():
    """The same, where it may read EXR files."""
    with scalar_variant() as mi, device.bitmaps():
        yield mi


def mitsuba_hits(path, origins, directions):
    """Distance (inf: none), whether the front was hit, and the reflectance there, of each ray."""
    with scalar_mitsuba() as mi:
        scene = mi.load_file(str(path), optimize=False)
        rows = []
        for origin, direction in zip(origins, directions, strict=True):
            si = scene.ray_intersect(mi.Ray3f(mi.Point3f(*origin), mi.Vector3f(*direction)))
            if not si.is_valid():
                rows.append((np.inf, False, np.zeros(3)))
                continue
            albedo = np.array(si.bsdf().eval_diffuse_reflectance(si)) if si.wi.z > 0 else np.zeros(3)
            rows.append((float(si.t), si.wi.z > 0, albedo))
    return tuple(map(np.array, zip(*rows, strict=True)))


def our_hits(scene, origins, directions):
    """The same for ours, by trying every face."""
    (corner, one, two), direction = scene.frames, directions[:, None]
    across, offset = np.cross(direction, two), origins[:, None] - corner
    turned = np.cross(offset, one)
    with np.errstate(divide="ignore", invalid="ignore"):
        determinant = (one * across).sum(axis=-1)
        u, v, t = ((x * y).sum(axis=-1) / determinant for x, y in ((offset, across), (turned, direction), (turned, two)))
        inside = (u >= 0) & (v >= 0) & np.where(scene.is_quad, (u <= 1) & (v <= 1), u + v <= 1) & (t > 0)
    t = np.where(inside, t, np.inf)
    ray, face = np.arange(len(t)), t.argmin(axis=1)
    distance, hit = t[ray, face], inside.any(axis=1)
    front = hit & ((scene.normal[face] * directions).sum(axis=1) < 0)
    albedo = np.where(hit[:, None], scene.reflectance[face], np.zeros(3))
    if scene.reflectance_paint is not None:
        some = ray[hit], face[hit]
        albedo[hit] *= scene.reflectance_paint.factor(face[hit], u[some], v[some], scene.is_quad[face[hit]])
    return distance, front, albedo
