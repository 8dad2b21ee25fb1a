"""Uniform points on patches, for programs that are asked what arrives there."""

import numpy as np

import radiosity as rd


def on_patches(patches: rd.Patches, each: int, generator: np.random.Generator) -> np.ndarray:
    """(n_patches, each, 3) metres, uniform on each patch."""
    x = generator.random((2, len(patches), each))
    corners, quad = patches.corners, patches.scene.is_quad[patches.face]
    fold = (x.sum(axis=0) > 1) & ~quad[:, None]
    u, v = np.where(fold, 1 - x, x)[..., None]
    last = np.where(quad[:, None], corners[:, 3], corners[:, 2])
    edges = corners[:, 1] - corners[:, 0], last - corners[:, 0]
    return corners[:, None, 0] + u * edges[0][:, None] + v * edges[1][:, None]
