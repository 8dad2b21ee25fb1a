"""Values that files often hold although they are not quite right: they are taken, with one warning a kind.

Values that make no sense are errors.
"""

import warnings
from dataclasses import replace

import numpy as np

from ..errors import RadiosityWarning, SceneError, shown
from .arguments import LARGEST
from .parts import Part, ReadOptions

DEFAULT_REFLECTANCE = 0.5
MOST_CLEAR = 1 - 1e-9  # a transmittance; what is above is refused later
BELOW_ONE = float(np.nextafter(1.0, 0.0))


def settle(parts: list[Part], source: str, options: ReadOptions) -> list[Part]:
    """Parts with a reflectance each, at most ``options.max_reflectance`` (where painted: the paint's limit does it),
    but what the user's own .toml sets below 1.

    Raises:
        SceneError: a coordinate, colour, reflectance or emission that makes no sense.
    """
    missing, bright, glossy, absent, result = {}, {}, {}, {}, []
    for part in parts:
        _check_arrays(part, source)
        m = part.material
        if m.transmittance >= 1 and not any(m.emission):
            absent[part.name] = True
            continue
        if not m.diffuse:
            glossy[part.name] = True
        if m.reflectance is None:
            missing[part.name] = True
            m = replace(m, reflectance=(DEFAULT_REFLECTANCE,))
        _check_values(part.name, m, source)
        for value in (m.reflectance, m.back_reflectance):
            highest = 0.0 if value is None else _most_given_back(part, value)
            highest /= 1 - min(m.transmittance, MOST_CLEAR)  # of what does not go through
            if highest > options.max_reflectance + 1e-12 and not m.given:
                of_file = bright.setdefault(m.origin or source, {})
                of_file[part.name] = max(of_file.get(part.name, 0.0), highest)
        part = part if m is part.material else replace(part, material=m)
        result.append(part if m.given else _lower(part, options.max_reflectance * (1 - min(m.transmittance, MOST_CLEAR))))
    if missing:
        warn(f"{source}: no material for {shown(missing)}; reflectance {DEFAULT_REFLECTANCE} taken")
    if absent:
        warn(f"{source}: surfaces that let all light through are not there, and left out: {shown(absent)}")
    for file, those in bright.items():
        warn(
            f"{file}: reflectance above {options.max_reflectance:g} brought down to it (at most {max(those.values()):.4g}): "
            f"{shown(those)}; --max-reflectance sets the bound, and what a .toml sets below 1 is taken as it is"
        )
    if glossy:
        warn(f"{source}: not diffuse, taken by the diffuse albedo: {shown(glossy)}")
    return result


def warn(text: str) -> None:
    """Give one `RadiosityWarning`."""
    warnings.warn(text, RadiosityWarning, stacklevel=4)


def _peak(part: Part) -> np.ndarray:
    """Return the highest factor of the paint in each band, (n_bands,)."""
    peak = np.ones(1)
    if part.color is not None and len(part.color):
        peak = peak * part.color.max(axis=0)
    if part.texture is not None and part.texture.size:
        peak = peak * part.texture.max(axis=(0, 1))
    return peak


def _most_given_back(part: Part, reflectance) -> float:
    """Return the largest share of light that a face gives back to either side: what it reflects, and what it lets through
    diffusely."""
    return float(np.max(np.asarray(reflectance) * _peak(part) + np.asarray(part.material.diffuse_transmittance or 0.0)))


def _lower(part: Part, limit: float) -> Part:
    m = part.material
    front = m.reflectance or ()
    if m.transmittance > 0 or m.diffuse_transmittance:  # the paint's limit is that of opaque faces
        highest = max(_most_given_back(part, value) for value in (front, m.back_reflectance or front))
        share = min(limit / highest, 1.0) if highest > 0 else 1.0
        front, back, through = (
            value and tuple(v * share for v in value) for value in (front, m.back_reflectance, m.diffuse_transmittance)
        )
        return replace(part, material=replace(m, reflectance=front, back_reflectance=back, diffuse_transmittance=through))
    if part.color is None and part.texture is None:
        if max((*front, *(m.back_reflectance or ()))) <= limit:
            return part
        back = m.back_reflectance and tuple(min(v, limit) for v in m.back_reflectance)
        return replace(part, material=replace(m, reflectance=tuple(min(v, limit) for v in front), back_reflectance=back))
    if max(front) > limit and _has_white_face(part):
        # a paint that is 1 everywhere is none, and would leave the base as it is
        base = np.minimum(front, limit)
        share = np.where(base > 0, np.asarray(front) / np.where(base > 0, base, 1), 1)
        back = m.back_reflectance and tuple(float(v) for v in np.asarray(m.back_reflectance) / share)
        m = replace(m, reflectance=tuple(float(v) for v in base), back_reflectance=back)
        return replace(part, color=np.asarray(part.color) * share, material=m)
    if max(front) >= 1.0:
        # a base of 1 and more moves into the corner colours, so that the product stays what the file says
        color = np.ones((len(part.vertices), 1)) if part.color is None else part.color
        part = replace(part, color=color * np.asarray(front))
        m = replace(m, reflectance=(BELOW_ONE,))
    back = m.back_reflectance and tuple(min(v, BELOW_ONE) for v in m.back_reflectance)
    return replace(part, material=replace(m, back_reflectance=back))


def _has_white_face(part: Part) -> bool:
    """Return whether some face has no image and the colour 1 at all corners."""
    if part.texture is not None or part.color is None:
        return False
    faces, white = np.asarray(part.faces), (np.asarray(part.color, np.float32) == 1).all(axis=1)
    return bool((white[faces] | (faces < 0)).all(axis=1).any())


def _check_values(name: str, m, source: str) -> None:
    for which in ("reflectance", "back_reflectance", "diffuse_transmittance"):
        for v in getattr(m, which) or ():
            if not 0 <= v < LARGEST:
                what = f"{which.replace('_', ' ')} of surface '{name}'"
                raise SceneError(f"{source}: {what} is {v:g}; it must lie in [0, 1): strictly below 1")
    for v in (*m.emission, *(m.back_emission or ())):
        if not 0 <= v < LARGEST:
            text = f"it must be finite and not negative, below {LARGEST:g}"
            raise SceneError(f"{source}: emission of surface '{name}' is {v:g}; {text}")


def _check_arrays(part: Part, source: str) -> None:
    """Refuse coordinates and colours out of range, of vertices that faces use."""
    faces = np.asarray(part.faces)
    for values, what, low, high in (
        (part.vertices, "coordinates", -np.inf, np.inf),
        (part.color, "colour", 0.0, LARGEST),
        (part.emission_color, "emitted colour", 0.0, LARGEST),
        (part.uv, "texture coordinates", -LARGEST, LARGEST),
        (part.emission_uv, "texture coordinates", -LARGEST, LARGEST),
    ):
        if (
            values is None
            or not np.size(values)
            or (low <= np.min(values) <= np.max(values) <= high and np.isfinite(values).all())
        ):
            continue
        used = np.zeros(len(part.vertices), bool)
        used[faces[faces >= 0]] = True
        good = np.all(np.isfinite(values) & (values >= low) & (values <= high), axis=1)
        if not good[used].all():
            vertex = int(np.flatnonzero(used & ~good)[0])
            face = int(np.flatnonzero((faces == vertex).any(axis=1))[0])
            rule = "must be finite" + (" and not negative" if low == 0 else "") + (f", at most {high:g}" if high < np.inf else "")
            raise SceneError(
                f"{source}: {what} of vertex {vertex} (face {face} of surface '{part.name}') "
                f"are {np.asarray(values)[vertex].tolist()}; they {rule}"
            )
    for image, what in ((part.texture, "texture"), (part.emission_texture, "emission texture")):
        if image is not None and not ((image >= 0) & (image <= LARGEST)).all():
            raise SceneError(f"{source}: the {what} of surface '{part.name}' holds values that are negative or not finite")
