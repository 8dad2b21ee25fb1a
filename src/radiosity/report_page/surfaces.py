"""Tables of surfaces and of light sources."""

import numpy as np

from ..scene.model import Scene
from ..solution.model import Solution
from ..solution.sides import BACK
from .markup import Markup, element, section, table
from .words import Words, number, percent, single, total

SIDES = {"front": "front", "back": "back", "lit": "lit side", "both": "no light"}


def surface_tables(solution: Solution, most: int) -> Markup:
    """Return the table of the largest surfaces, side by side where light reaches both."""
    scene = solution.patches.scene
    words, rows = Words.of(scene), by_light(solution)
    colours = scene.n_bands > 1 and not (scene.photometric and scene.n_bands == 3)
    heads = ["surface", "side", "area [m²]", "reflectance"]
    heads += [
        f"{words.falling}{f' {band}' if colours else ''} [{words.falling_unit}]" for band in (scene.bands if colours else [""])
    ]
    heads += ["±", f"{words.leaving} [{words.leaving_unit}]", f"{words.power} received [{words.power_unit}]"]
    reflectance = dict(zip(_keys(solution), _reflectances(solution), strict=True))
    lines = []
    for row in rows[:most]:
        received, left, falling = (
            np.array([row[key + tail] for tail in _tails(scene)]) for key in ("received", "radiosity", "irradiance")
        )
        shown = [number(value) for value in falling] if colours else [number(float(single(scene, falling)))]
        lines.append(
            [
                row["surface"],
                SIDES[row["side"]],
                number(row["area"]),
                percent(reflectance[row["surface"], row["side"]]),
                *shown,
                percent(row["interval"]),
                number(float(single(scene, left)) / np.pi),
                number(float(total(scene, received))),
            ]
        )
    about = "Means over surfaces. ±: the mean lies within this share of the value in 95 of 100 calculations."
    parts = [
        element("p", about, class_="small"),
        table("Surfaces, those that receive most light first", heads, lines, numeric_from=2),
    ]
    if len(rows) > most:
        rest = sum(row["area"] for row in rows[most:])
        parts.append(element("p", f"{len(rows) - most} surfaces with less light ({number(rest)} m² in all) are left out here."))
    twice = [row["surface"] for row in rows if row["side"] == BACK and not row["dark"]]
    if twice:
        parts.append(element("p", "Surfaces with light on both sides have a row for each side.", class_="small"))
    return section("Surfaces", *parts, kind="page")


def by_light(solution: Solution) -> list[dict]:
    """Return the rows of the table of surfaces, those that receive most light first."""
    scene = solution.patches.scene
    rows = solution.surface_table()
    received = [float(total(scene, np.array([row["received" + tail] for tail in _tails(scene)]))) for row in rows]
    return [rows[i] for i in np.argsort(-np.nan_to_num(received), kind="stable")]


def source_table(solution: Solution, most: int) -> Markup | None:
    """Return the table of what sends light by itself; None where nothing does."""
    scene = solution.patches.scene
    words, rows = Words.of(scene), []
    for row in solution.surface_table():
        emitted = np.array([row["emitted" + tail] for tail in _tails(scene)])
        if emitted.any():
            power = float(total(scene, emitted))
            rows.append((f"{row['surface']} ({SIDES[row['side']]})", "surface", power, f"{number(row['area'])} m²"))
    for lamp in scene.lights.luminaires:
        rows.append((lamp.name, "luminaire", float(total(scene, _wide(lamp.power, scene))), _place(lamp.position)))
    rows.sort(key=lambda row: -row[2])
    lines = [[name, kind, number(power), where] for name, kind, power, where in rows[:most]]
    parts: list[Markup] = []
    if lines:
        heads = ["light source", "kind", f"{words.power} [{words.power_unit}]", "size or place"]
        parts.append(
            table(
                f"Lamps, the strongest first: {number(sum(row[2] for row in rows))} {words.power_unit} in all",
                heads,
                lines,
                numeric_from=2,
            )
        )
    if len(rows) > most:
        parts.append(element("p", f"{len(rows) - most} weaker sources are left out here."))
    far = [
        f"{sun.name}: {number(float(single(scene, _wide(sun.irradiance, scene))))} {words.falling_unit} across its light"
        for sun in scene.lights.suns
    ]
    sky = scene.lights.sky
    if sky is not None:
        level = number(float(single(scene, _wide(sky.horizontal, scene))))
        far.append(f"{sky.name}{f' ({sky.kind})' if sky.kind else ''}: {level} {words.falling_unit} on a level plane outside")
    parts += [element("p", text) for text in far]
    return section("Light sources", *parts) if parts else None


def _keys(solution: Solution) -> list[tuple[str, str]]:
    names, sides = solution.patches.scene.names, solution.sides
    return [(names[surface], side) for surface, side in zip(sides.surface, sides.side, strict=True)]


def _reflectances(solution: Solution) -> np.ndarray:
    """Area means of the reflectance over the rows of the table, one number for all bands."""
    row, patches = solution.sides.row, solution.patches
    some, n = row >= 0, len(solution.sides.surface)
    values = single(patches.scene, patches.reflectance[some])
    area = np.bincount(row[some], patches.area[some], n)
    return np.bincount(row[some], patches.area[some] * values, n) / np.where(area > 0, area, 1)


def _tails(scene: Scene) -> list[str]:
    return [f" [{band}]" for band in scene.bands] if scene.n_bands > 1 else [""]


def _wide(values: np.ndarray, scene: Scene) -> np.ndarray:
    return np.broadcast_to(values, (scene.n_bands,))


def _place(position: np.ndarray) -> str:
    return "at " + ", ".join(f"{x:.3g}" for x in position) + " m"
