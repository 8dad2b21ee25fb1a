"""`write_report`: the page of a solution, and its PDF."""

import warnings
from dataclasses import fields
from pathlib import Path, PurePath

import numpy as np

from ..errors import MethodError, OutputError, RadiosityWarning
from ..image.output import check_writable, require, require_results
from ..scene.model import Scene
from ..solution.model import Solution
from ..solution.whole import whole_file
from . import pdf
from .markup import Markup, element, facts, section
from .pictures import views
from .plans import plan_views
from .quality import balance, certainty, spot_error, to_know
from .sensor_sets import SensorSet, of_measurement, of_table
from .sensors import sensor_tables
from .style import STYLE
from .surfaces import by_light, source_table, surface_tables
from .wishes import Wishes
from .words import Words, number, percent, single, total

SUFFIXES = (".html", ".htm", ".pdf")
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'"  # a page that loads nothing, and runs nothing
ERROR = 0.01  # of the sensors that the scene asks for


def check(paths) -> None:
    """Refuse, before any work, outputs that could not be written after it.

    Raises:
        OutputError: an unknown format, a folder that cannot be written to, a file named twice, or a program that is missing.
    """
    seen: set[Path] = set()
    for path in map(Path, paths):
        if check_writable(path, SUFFIXES).resolve() in seen:
            raise OutputError(f"{path} is named twice; give each output its own name")
        seen.add(path.resolve())
        if path.suffix.lower() == ".pdf":
            pdf.browser(path)
        for module in ("matplotlib", "PIL"):
            require(module, f"{path}: a report")


def write_report(solution: Solution, *paths, progress=None, **wishes) -> None:
    """Write a report for a client: one .html file that needs no other, or a .pdf of it.

    It has views, plans in false colours with isolines, measuring points, tables of surfaces and light sources, the energy
    balance, how sure the figures are, warnings, and how they were calculated. Equal solutions and wishes give equal bytes.

    Args:
        solution: to report on.
        paths: .html or .pdf files. A .pdf is printed by Chromium or Chrome.
        progress: of the final gather and the sensors; see `radiosity.solve`.
        wishes: any of

            - title, project, client, author, date, remarks: texts of the first page; no date is written unless it is given
            - cameras: `Camera` values or numbers of the scene's; default: the scene's first four, or a fitted one
            - width: of pictures, pixels
            - final_gather, seed: lines for each pixel of the views, see `radiosity.image.render`
            - plans: names or patterns of level surfaces; default: the three that receive most light
            - measured: .csv files of `radiosity measure`
            - sensors: measure the sensors that the scene asks for (default: True)
            - check: look for gaps and mistakes in the scene (default: True)
            - rows: of tables of surfaces and light sources, at most

    Raises:
        OutputError: a file cannot be written, or Chromium, matplotlib or Pillow is missing.
        MethodError: a wish is not known, or no surface is called so.
        SceneError: a table of sensors or a camera makes no sense.

    Example:
        >>> solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=2), rays=20_000)
        >>> rd.write_report(solution, "room.html", title="The room", width=80, check=False)
        >>> from pathlib import Path
        >>> "<h1>The room</h1>" in Path("room.html").read_text(encoding="utf-8")
        True
    """
    unknown = [name for name in wishes if name not in {field.name for field in fields(Wishes)}]
    if unknown:
        known = ", ".join(field.name for field in fields(Wishes))
        raise MethodError(f"a report has no '{unknown[0]}'; known are {known}")
    if not paths:
        raise OutputError("no output; name a file, such as report.html")
    check(paths)
    page = html(solution, _wishes(wishes), progress)
    for path in map(Path, paths):
        if path.suffix.lower() == ".pdf":
            pdf.write(page, path)
        else:
            with whole_file(path) as file:
                file.write(page.encode())


def html(solution: Solution, wishes: Wishes, progress=None) -> str:
    """Return the page.

    Raises:
        OutputError, MethodError, SceneError: see `write_report`.
    """
    from ..diagnostics.check import check as check_scene

    require_results(solution)
    scene = solution.patches.scene
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RadiosityWarning)
        sets = _sensors(solution, wishes, progress)
        checked = check_scene(scene) if wishes.check else None
        summary = _summary(solution, sets)
        parts = [
            views(solution, wishes, progress),
            plan_views(solution, wishes.plans),
            sensor_tables(sets, Words.of(scene)),
            surface_tables(solution, wishes.rows),
            source_table(solution, wishes.rows),
            balance(solution),
            certainty(solution),
        ]
    told = [str(one.message) for one in caught if issubclass(one.category, RadiosityWarning)]
    parts = [summary, to_know(solution, checked, told), *parts, _provenance(solution, wishes), _words(scene)]
    title = wishes.title or f"Light calculation: {_called(scene.source)}"
    head = element(
        "head",
        element("meta", charset="utf-8"),
        element("meta", http_equiv="Content-Security-Policy", content=POLICY),
        element("meta", name="viewport", content="width=device-width, initial-scale=1"),
        element("meta", name="generator", content="radiosity"),
        element("title", title),
        element("style", Markup(STYLE)),
    )
    body = element("body", element("header", *_heading(title, wishes)), element("main", *parts))
    return f"<!doctype html>\n{element('html', head, body, lang='en')}\n"


def _wishes(given: dict) -> Wishes:
    for name in ("cameras", "plans", "measured"):
        if name in given:
            value = given[name]
            given = given | {name: (value,) if isinstance(value, str | Path | int) else tuple(value)}
    wishes = Wishes(**given)
    for name, least in (("width", 1), ("rows", 1)):
        value = getattr(wishes, name)
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
            raise MethodError(f"{name} is {value!r}; it must be a whole number of {least} or more")
    return wishes


def _heading(title: str, wishes: Wishes) -> list[Markup]:
    pairs = [(name.capitalize(), getattr(wishes, name)) for name in ("project", "client", "author", "date")]
    given = [(name, value) for name, value in pairs if value]
    remarks = [element("p", line) for line in wishes.remarks.splitlines() if line.strip()]
    return [element("h1", title), *([facts(given)] if given else []), *remarks]


def _sensors(solution: Solution, wishes: Wishes, progress) -> list[SensorSet]:
    from ..sensors.measure import measure
    from ..sensors.model import Sensors

    scene = solution.patches.scene
    sets = [one for path in wishes.measured for one in of_table(Path(path), photometric=scene.photometric)]
    if wishes.sensors and scene.sensors and not wishes.measured:
        found = measure(solution, Sensors.of_scene(scene), error=ERROR, seed=wishes.seed, progress=progress)
        sets += of_measurement(found)
    return sets


def _summary(solution: Solution, sets: list[SensorSet]) -> Markup:
    scene, rows = solution.patches.scene, solution.surface_table()
    words = Words.of(scene)
    power = float(total(scene, np.array([book["emitted"] for book in solution.books])))
    keys = [
        (
            f"{number(power)} {words.power_unit}",
            f"{words.power} {'of lamps, sun and sky' if scene.lights.suns or scene.lights.sky else 'of all light sources'}",
        )
    ]
    for one in sets[:3]:
        if len(one.values):
            keys.append((f"{number(one.values.mean())} {words.falling_unit}", f"mean {words.falling}, {one.name}"))
    if len(keys) == 1:
        tails = [f" [{band}]" for band in scene.bands] if scene.n_bands > 1 else [""]
        rows_of_light = by_light(solution)
        rooms = [row for row in rows_of_light if not any(row[f"emitted{tail}"] for tail in tails)]
        for row in (rooms or rows_of_light)[:3]:
            mean = float(single(scene, np.array([row[f"irradiance{tail}"] for tail in tails])))
            keys.append((f"{number(mean)} {words.falling_unit}", f"mean {words.falling}, {row['surface']}"))
    spot = spot_error(solution)
    keys.append((f"± {percent(spot)}" if np.isfinite(spot) else percent(spot), "typical error of a single spot"))
    boxes = element(
        "div", *(element("div", element("strong", value), element("span", name)) for value, name in keys), class_="key"
    )
    area = sum(row["area"] for row in rows)
    about = (
        f"The scene has {len(scene.names):,} surfaces with {number(area)} m² of lit sides. Light goes from surface to surface "
        "until it is absorbed; all surfaces are taken as matt."
    )
    return section("In short", element("p", about), boxes)


def _provenance(solution: Solution, wishes: Wishes) -> Markup:
    known, scene = solution.provenance, solution.patches.scene
    versions = known.get("versions")
    versions = versions if isinstance(versions, dict) else {}
    pairs: list[tuple[str, object]] = [
        ("Scene", _called(scene.source)),
        ("Scene hash", known.get("scene", scene.hash)),
        ("Faces", f"{scene.n_faces:,}"),
        ("Patches", f"{len(solution.patches):,}"),
        ("Method", known["method"]),
        ("Seed", known["seed"]),
        ("Repetitions", solution.replicates),
        ("Lines", f"{solution.rays:,}"),
        ("Packets for each repetition", f"{solution.quanta:,}"),
        ("Status", solution.status),
        ("Device", known.get("device", "unknown")),
        ("Versions", ", ".join(f"{name} {version}" for name, version in versions.items())),
    ]
    if isinstance(known.get("auto"), dict):
        pairs.insert(5, ("Method chosen", f"{known['auto'].get('chosen')}: {known['auto'].get('why')}"))
    if wishes.final_gather:
        pairs.append(("Views", f"{wishes.final_gather} lines for each pixel, seed {wishes.seed}"))
    about = "With the same scene, method, seed and versions the calculation gives the same figures again."
    return section("How it was calculated", element("p", about, class_="small"), facts(pairs), kind="keep")


def _words(scene: Scene) -> Markup:
    words = Words.of(scene)
    pairs: list[tuple[str, object]] = [
        (words.falling.capitalize(), f"light that falls on a surface, for each square metre, in {words.falling_unit}"),
        (words.leaving.capitalize(), f"light that leaves a surface towards the eye, in {words.leaving_unit}"),
        (words.power.capitalize(), f"all light of a source, or on a surface, in {words.power_unit}"),
        ("Reflectance", "share of the light that a surface throws back"),
        ("Uniformity", "the lowest value over the mean, or over the highest"),
        ("±", "half of the range that holds the true value of the calculation in 95 of 100 cases"),
    ]
    if scene.n_bands > 1 and not scene.photometric:
        how = "red, green and blue weighted as the eye does" if scene.n_bands == 3 else "the mean of all bands"
        pairs.append(("One number for all bands", f"{how}, of {words.falling} and {words.leaving}; powers are sums"))
    if not scene.photometric:
        pairs.append(("Watts", "the scene gives radiant power, not light as the eye weighs it: there are no lux"))
    return section("Words", facts(pairs), kind="keep")


def _called(source: str) -> str:
    """Return the name of a scene's file without its folder, which is nobody's business."""
    return PurePath(source.replace("\\", "/")).name or source
