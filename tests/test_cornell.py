"""`cornell-box` against a dense solve on the same patches, and against Mitsuba's own path tracer."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.patches import cells
from radiosity.tracing.first_hits import first_hits


def cast_form_factors(patches, lines: int, random) -> np.ndarray:
    """F by counting hits of numpy's own random lines, independent of the engine's lines and numbers."""
    n, scene = len(patches), patches.scene
    corners, quad = patches.corners, scene.is_quad[patches.face]
    normal = patches.normal
    tangent = corners[:, 1] - corners[:, 0]
    tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
    bitangent = np.cross(normal, tangent)
    x = random.random((n, lines, 4))
    fold = (x[..., 0] + x[..., 1] > 1) & ~quad[:, None]
    u, v = np.where(fold, 1 - x[..., 0], x[..., 0]), np.where(fold, 1 - x[..., 1], x[..., 1])
    last = np.where(quad[:, None], corners[:, 3], corners[:, 2])
    first_edge, second_edge = corners[:, 1] - corners[:, 0], last - corners[:, 0]
    origin = corners[:, None, 0] + u[..., None] * first_edge[:, None] + v[..., None] * second_edge[:, None]
    angle, sine = 2 * np.pi * x[..., 2], np.sqrt(x[..., 3])
    direction = (sine * np.cos(angle))[..., None] * tangent[:, None] + (sine * np.sin(angle))[..., None] * bitangent[:, None]
    direction += np.sqrt(1 - x[..., 3])[..., None] * normal[:, None]
    hits = first_hits(scene, (origin + 1e-7 * normal[:, None]).reshape(-1, 3), direction.reshape(-1, 3))
    face = np.maximum(hits.face, 0)
    cell = cells.number(hits.u, hits.v, patches.columns[face], patches.rows[face], scene.is_quad[face])
    front = hits.front | (scene.back[face] == rd.Back.RADIATES)
    patch = patches.first[face] + cell + np.where(hits.front, 0, patches.cells_per_face[face])
    seen = (hits.face >= 0) & front
    source = np.repeat(np.arange(n), lines)
    return np.bincount(source[seen] * n + patch[seen], minlength=n * n).reshape(n, n) / lines


@pytest.mark.slow
def test_dense_solve_on_the_same_patches(random):
    patches = rd.subdivide(rd.load_scene("cornell-box"), cells=3)
    n, batches = len(patches), 24
    dense = np.zeros((batches, n, 3))
    for i in range(batches):
        factors = cast_form_factors(patches, 3000, random)
        for band in range(3):
            matrix = np.eye(n) - patches.reflectance[:, band, None] * factors
            dense[i, :, band] = np.linalg.solve(matrix, patches.emission[:, band])
    mean, error = dense.mean(axis=0), dense.std(axis=0, ddof=1) / np.sqrt(batches)
    solution = rd.solve(patches, "random-walk", rays=10_000_000, replicates=8)
    both = np.hypot(error, solution.standard_error)
    known = both > 0
    z = (solution.radiosity - mean)[known] / both[known]
    # 193 patches in 3 bands, 23 degrees of freedom or more where the dense error dominates: p(|t| > 6) = 4e-6 each
    assert np.abs(z).max() < 6
    assert 0.8 < np.sqrt(np.mean(z**2)) < 1.25
    assert np.abs(z.mean()) < 0.5  # neighbours share lines, so the mean is no sum of independent errors
    area = patches.area
    scale = np.sqrt(area @ (mean - patches.emission) ** 2)
    assert (np.sqrt(area @ (solution.radiosity - mean) ** 2) < 1.3 * np.sqrt(area @ both**2)).all()
    assert (np.sqrt(area @ both**2) < 0.03 * scale).all()


def path_traced(patches, paths: int, batches: int = 8) -> tuple[np.ndarray, np.ndarray]:
    """Mean radiosity of patches, and its standard error, by Mitsuba's path integrator: rays straight onto the patch."""
    from radiosity.device.backend import choose, entered, upload

    device = choose("cpu")
    scene, types = patches.scene, device.types
    generator = np.random.Generator(np.random.Philox(99))
    with entered(device) as mi:
        parts: dict = {"type": "scene", "integrator": {"type": "path", "max_depth": -1, "rr_depth": 12}}
        for face in range(scene.n_faces):
            corners = scene.vertices[scene.faces[face][: 4 if scene.is_quad[face] else 3]]
            mesh = mi.Mesh(f"face{face}", len(corners), len(corners) - 2, props=_properties(mi, scene, face))
            parameters = mi.traverse(mesh)
            parameters["vertex_positions"] = upload(types.Float, corners.astype(np.float32))
            parameters["faces"] = upload(types.UInt32, np.array([[0, 1, 2], [0, 2, 3]][: len(corners) - 2], np.uint32))
            parameters.update()
            parts[f"face{face}"] = mesh
        world = mi.load_dict(parts)
        n = len(patches)
        results = np.zeros((batches, n, 3))
        corners, quad = patches.corners, scene.is_quad[patches.face]
        last = np.where(quad[:, None], corners[:, 3], corners[:, 2])
        for batch in range(batches):
            x = generator.random((2, n, paths))
            fold = (x.sum(axis=0) > 1) & ~quad[:, None]
            u, v = np.where(fold, 1 - x, x)
            point = corners[:, None, 0] + u[..., None] * (corners[:, None, 1] - corners[:, None, 0])
            point = point + v[..., None] * (last - corners[:, 0])[:, None]
            normal = np.broadcast_to(patches.normal[:, None], point.shape).reshape(-1, 3)
            origin = point.reshape(-1, 3) + 1e-5 * normal
            ray = mi.RayDifferential3f(
                mi.Point3f(*(upload(types.Float, c.astype(np.float32)) for c in origin.T)),
                mi.Vector3f(*(upload(types.Float, -c.astype(np.float32)) for c in normal.T)),
            )
            sampler = mi.load_dict({"type": "independent"})
            sampler.seed(batch, len(origin))
            radiance, _, _ = world.integrator().sample(world, sampler, ray)
            results[batch] = np.pi * np.array(radiance).T.reshape(n, paths, 3).mean(axis=1)
    return results.mean(axis=0), results.std(axis=0, ddof=1) / np.sqrt(batches)


def _properties(mi, scene, face):
    properties = mi.Properties()
    diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": scene.reflectance[face].tolist()}}
    two_sided = scene.back[face] == rd.Back.RADIATES
    properties["bsdf"] = mi.load_dict({"type": "twosided", "bsdf": diffuse} if two_sided else diffuse)
    if scene.emission[face].any():
        radiance = {"type": "rgb", "value": (scene.emission[face] / np.pi).tolist()}
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    return properties


@pytest.mark.slow
def test_difference_from_the_path_tracer_falls_with_the_patch_size():
    """The path tracer solves the continuous equation: what is left is the discretisation error, and it vanishes."""
    scene = rd.load_scene("cornell-box")
    coarse = rd.subdivide(scene, cells=2)
    reference, noise = path_traced(coarse, 4000)
    rows = (coarse.surface != scene.names.index("light")) & (reference.min(axis=1) > 0)
    weight = coarse.area[rows]

    def rms(values):
        return np.sqrt(weight @ values[rows] ** 2 / (weight @ reference[rows] ** 2)).max()

    differences = []
    for k in (2, 4, 8, 16):
        patches = rd.subdivide(scene, cells=k)
        solution = rd.solve(patches, "random-walk", rays=8_000_000, replicates=8)
        column, row, inverted = patches.place
        middle = np.where(scene.is_quad[patches.face], 0.5, np.where(inverted, 2 / 3, 1 / 3))
        cell = cells.number(
            (column + middle) / k, (row + middle) / k, *(np.full(len(patches), 2) for _ in range(2)), scene.is_quad[patches.face]
        )
        parent = coarse.first[patches.face] + cell + np.where(patches.is_back, coarse.cells_per_face[patches.face], 0)
        assert np.array_equal(coarse.is_back[parent], patches.is_back)
        total = np.stack(
            [np.bincount(parent, weights=patches.area * b, minlength=len(coarse)) for b in solution.radiosity.T], axis=1
        )
        differences.append(rms(total / coarse.area[:, None] - reference))
    floor = rms(noise)
    print(
        f"\ncells, RMS difference from the path tracer (its noise {floor:.3%}): "
        + ", ".join(f"{k}: {d:.3%}" for k, d in zip((2, 4, 8, 16), differences, strict=True))
    )
    excess = np.sqrt(np.maximum(np.square(differences) - floor**2, 0))
    assert (excess[1:] < 0.75 * excess[:-1]).all()
    assert excess[-1] < excess[0] / 4
