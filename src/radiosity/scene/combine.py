"""The combination of several scenes to one."""

from dataclasses import replace

import numpy as np

from .lights.add import all_lights
from .model import Scene
from .paint import Paint
from .panes import of_all_faces


def combine(scenes: list[Scene], *, source: str, photometric: bool, scale: float) -> Scene:
    """The faces and lights of all scenes. Surfaces of equal name become one; grey scenes take the bands of coloured ones."""
    names = tuple(dict.fromkeys(name for scene in scenes for name in scene.names))
    index = {name: i for i, name in enumerate(names)}
    bands = max((scene.bands for scene in scenes), key=len)
    starts = np.cumsum([0] + [len(scene.vertices) for scene in scenes])
    patch_size = np.full(len(names), np.nan)
    for scene in scenes:
        for name, size in zip(scene.names, scene.patch_size, strict=True):
            patch_size[index[name]] = size if np.isfinite(size) else patch_size[index[name]]

    def stack(key: str) -> np.ndarray:
        values = [getattr(scene, key) for scene in scenes]
        return np.concatenate([np.broadcast_to(value, (len(value), len(bands))) for value in values])

    return replace(
        scenes[0],
        vertices=np.concatenate([scene.vertices for scene in scenes]),
        faces=np.concatenate([np.where(s.faces >= 0, s.faces + start, -1) for s, start in zip(scenes, starts, strict=False)]),
        reflectance=stack("reflectance"),
        emission=stack("emission"),
        back=np.concatenate([scene.back for scene in scenes]),
        back_reflectance=stack("back_reflectance"),
        back_emission=stack("back_emission"),
        surface=np.concatenate([np.array([index[name] for name in s.names], np.int32)[s.surface] for s in scenes]),
        transmittance=of_all_faces(scenes, "transmittance"),
        refractive_index=of_all_faces(scenes, "refractive_index"),
        diffuse_transmittance=of_all_faces(scenes, "diffuse_transmittance", len(bands)),
        names=names,
        bands=bands,
        photometric=photometric,
        patch_size=patch_size,
        reflectance_paint=_paints(scenes, "reflectance_paint", len(bands)),
        emission_paint=_paints(scenes, "emission_paint", len(bands)),
        cameras=tuple(camera for scene in scenes for camera in scene.cameras),
        scale=scale,
        source=source,
        lights=all_lights(scenes, len(bands), source),
        cut=scenes[0].cut if len(scenes) == 1 else None,
        assumed=tuple(dict.fromkeys(name for scene in scenes for name in scene.assumed)),
    )


def _paints(scenes: list[Scene], key: str, n_bands: int) -> Paint | None:
    """The paints of all faces; faces of scenes without one are multiplied by 1."""
    paints = [getattr(scene, key) for scene in scenes]
    if all(paint is None for paint in paints):
        return None
    images, samplers, image, uv, color, limit = [], [], [], [], [], np.inf
    for scene, paint in zip(scenes, paints, strict=True):
        n = scene.n_faces
        if paint is None:
            paint = Paint((), np.full(n, -1, np.int32), np.zeros((n, 4, 2), np.float32), np.ones((n, 4, 1), np.float32))
        paint = paint.in_bands(n_bands)
        image.append(np.where(paint.image >= 0, paint.image + len(images), -1).astype(np.int32))
        samplers += [paint.sampler(index) for index in range(len(paint.images))]
        images += paint.images
        uv.append(paint.uv)
        color.append(paint.color)
        limit = min(limit, paint.limit)
    return Paint(tuple(images), np.concatenate(image), np.concatenate(uv), np.concatenate(color), limit, tuple(samplers))
