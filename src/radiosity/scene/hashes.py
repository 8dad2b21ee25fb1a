"""Hashes of a scene: of all that a solution depends on, and of what its lines depend on.

What older versions did not have changes no hash where it is not there.
"""

import hashlib

import numpy as np

from .sampler import DEFAULT_SAMPLER


def hash_of(scene) -> str:
    """Return the SHA-256 of everything that a solution depends on."""
    digest = _digest(
        scene.vertices,
        scene.faces,
        scene.reflectance,
        scene.emission,
        scene.back,
        scene.back_reflectance,
        scene.back_emission,
        scene.surface,
    )
    for paint in (scene.reflectance_paint, scene.emission_paint):
        for array in () if paint is None else (*paint.images, paint.image, paint.uv, paint.color, np.array(paint.limit)):
            digest.update(np.ascontiguousarray(array).tobytes())
        if paint is not None and any(sampler != DEFAULT_SAMPLER for sampler in paint.samplers):
            digest.update(repr(paint.samplers).encode())
    if scene.lights:
        digest.update(scene.lights.digest())
    digest.update(repr((scene.names, scene.bands, scene.photometric)).encode())
    if scene.diffuse_transmittance is not None:
        digest.update(b"diffuse" + _digest(scene.diffuse_transmittance).digest())
    return _with_panes(scene, digest).hexdigest()


def geometry_hash_of(scene) -> str:
    """Return the SHA-256 of everything that lines depend on: faces, backs, panes and surfaces."""
    return _with_panes(scene, _digest(scene.vertices, scene.faces, scene.back, scene.surface)).hexdigest()


def _with_panes(scene, digest):
    """Add the panes to a digest, where there are any."""
    if scene.transmittance is not None:
        digest.update(_digest(scene.transmittance).digest())
    if scene.refractive_index is not None:
        digest.update(b"index" + _digest(scene.refractive_index).digest())
    return digest


def _digest(*arrays: np.ndarray):
    """Return a SHA-256 of arrays, with their types and shapes."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(str((array.dtype.str, array.shape)).encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest
