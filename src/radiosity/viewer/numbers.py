"""The numbers of a patch, as the page tells them when it is clicked."""

import numpy as np

from ..scene.photopic import photopic
from .subject import Subject

PLACES = 4  # digits


def told(subject: Subject, patch: int, point) -> str:
    """Return the numbers of a patch as Markdown: surface and side, then what is known of it, with 95 % intervals.

    Args:
        subject: what is shown.
        patch: its number.
        point: (3,) m, where it was clicked.
    """
    patches, scene, solution = subject.patches, subject.patches.scene, subject.solution
    rows = [
        ("side", "back" if patches.is_back[patch] else "front"),
        ("patch, face", f"{patch}, {int(patches.face[patch])}"),
        ("area", f"{patches.area[patch]:.{PLACES}g} m²"),
        ("point", ", ".join(f"{value:.{PLACES}g}" for value in point) + " m"),
    ]
    if scene.transmittance is not None:
        rows.append(("transmittance", _number(patches.transmittance[patch])))
    if patches.diffuse_transmittance is not None:
        through = _bands(scene, patches.diffuse_transmittance[patch])
        rows += [(_of("diffuse transmittance", band, scene.bands), _number(value)) for band, value in through]
    rows += [(_of("reflectance", band, scene.bands), _number(v)) for band, v in _bands(scene, patches.reflectance[patch])]
    rows += [
        (_of("emission", band, scene.bands), f"{_number(v)} {scene.unit}") for band, v in _bands(scene, patches.emission[patch])
    ]
    if solution is not None:
        intervals = subject.interval(patch)
        for title, unit in (("radiosity", solution.unit), ("irradiance", solution.irradiance_unit)):
            low, high = intervals[title]
            for i, (band, value) in enumerate(_bands(scene, getattr(solution, title)[patch])):
                known = np.isfinite([low[i], high[i]]).all()
                between = f" ({_number(low[i])} to {_number(high[i])})" if known else " (error unknown)"
                rows.append((_of(title, band, scene.bands), f"{_number(value)} {unit}{between}"))
        lit = photopic(scene, np.asarray(solution.irradiance)[patch][None])
        if lit is not None:
            rows.append(("illuminance", f"{_number(lit[0])} lx"))
        rows.append(("lines that hit it", f"{int(solution.arrivals[patch]):,}"))
    text = f"**{plain(scene.names[patches.surface[patch]])}**\n\n| | |\n|---|---|\n"
    text += "".join(f"| {name} | {value} |\n" for name, value in rows)
    if solution is None:
        return f"{text}\nnot solved yet"
    if solution.few[patch]:
        text += "\nno line reached it: value unknown" if solution.arrivals[patch] == 0 else "\nfew lines hit it"
    return text


def _bands(scene, values: np.ndarray) -> list[tuple[str, float]]:
    return list(zip((str(band) for band in scene.bands), values.tolist(), strict=True))


def _of(title: str, band: str, bands) -> str:
    return f"{title}, {band}" if len(bands) > 1 else title


def _number(value: float) -> str:
    return f"{value:.{PLACES}g}"


def plain(text: str) -> str:
    """Return a name of a file as Markdown that shows it as it is."""
    return "".join(f"\\{c}" if c in "\\`*_{}[]<>()#+-.!|~&" else c for c in text if c.isprintable())
