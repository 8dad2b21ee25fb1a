"""``radiosity check``"""

from ..errors import printable
from .options import DeviceName, Flag

COLORS = {"error": "bold red", "warning": "yellow", "note": "cyan"}
MOST_ROWS = 40
SMALL, LARGE = 0.05, 300.0  # metres: a scene outside this range is more often in another unit


def check(
    scene: str,
    /,
    *,
    max_reflectance: float = 0.95,
    strict: Flag = False,
    allow_outside: Flag = False,
    device: DeviceName = "auto",
) -> int:
    """Say what a scene holds and what in it is probably not meant.

    Parameters
    ----------
    scene
        A scene file or a built-in scene.
    max_reflectance
        Bring larger reflectances in files down to this; what your own .toml sets below 1 stays as it is.
    strict
        Faults in the scene that could be skipped with a warning are errors.
    allow_outside
        The scene may name files (includes, meshes, textures) outside its folder.
    device
        auto, cpu or cuda: what the lines are traced on.
    """
    from ..diagnostics.check import check_file

    report = check_file(scene, max_reflectance=max_reflectance, strict=strict, allow_outside=allow_outside, device=device)
    _print(report)
    return 1 if report.serious else 0


def _print(report) -> None:
    from rich.console import Console
    from rich.text import Text

    console = Console(highlight=False, soft_wrap=True)
    if report.scene is not None:
        for line in _facts(report):
            console.print(Text(line))
        Console(highlight=False, width=1000).print(_table(report))  # never cut off a name
        if len(report.surfaces) > MOST_ROWS:
            console.print(Text(f"and {len(report.surfaces) - MOST_ROWS} smaller surfaces"))
        luminaires = report.scene.lights.luminaires
        if luminaires:
            Console(highlight=False, width=1000).print(_luminaires(luminaires[:MOST_ROWS], report.scene.power_unit))
        if len(luminaires) > MOST_ROWS:
            console.print(Text(f"and {len(luminaires) - MOST_ROWS} more luminaires"))
    for finding in report.findings:
        console.print(Text(finding.severity, COLORS[finding.severity]), Text(printable(f"{finding.kind}: {finding.message}")))
    if not report.findings:
        console.print(Text("nothing suspicious found", "green"))


def _facts(report):
    from ..scene.lights.told import daylight

    scene = report.scene
    low, high = scene.bounds
    size = " x ".join(f"{d:.4g}" for d in high - low)
    yield printable(report.source)
    scale = "" if abs(scene.scale - 1) < 1e-12 else f" (a unit of the file is {scene.scale:g} m)"
    yield f"extent    {size} m{scale}, from {_point(low)} to {_point(high)}"
    if not SMALL <= (high - low).max() <= LARGE:
        yield 'size      rare for a scene: for another unit write unit = "mm" (cm, in, ft) in a .toml; powers depend on it'
    quads = int(scene.is_quad.sum())
    yield f"faces     {scene.n_faces}: {scene.n_faces - quads} triangles, {quads} parallelograms"
    yield f"surfaces  {len(report.surfaces)}, {sum(s.area for s in report.surfaces):.4g} m² radiating"
    yield f"bands     {', '.join(scene.bands)}"
    yield f"cameras   {len(scene.cameras)}"
    lights = [surface for surface in report.surfaces if any(surface.power)]
    power = " / ".join(f"{sum(s.power[b] for s in lights):.4g}" for b in range(scene.n_bands)) if lights else "0"
    yield f"emitters  {len(lights)}, {power} {scene.power_unit} in all"
    luminaires = scene.lights.luminaires
    if luminaires:
        totals = [f"{sum(one.power[b] for one in luminaires):.4g}" for b in range(scene.n_bands)]
        sent = totals[0] if len(set(totals)) == 1 else " / ".join(totals)
        yield f"luminaires  {len(luminaires)}, {sent} {scene.power_unit} in all"
    yield from (printable(line) for line in daylight(scene))


def _point(values) -> str:
    return "(" + ", ".join(f"{v:.4g}" for v in values) + ")"


def _table(report):
    from rich.table import Table
    from rich.text import Text

    unit, power = report.scene.unit, report.scene.power_unit
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("surface", no_wrap=True)
    for name in ("faces", "area m²", "reflectance", f"emission {unit}", f"power {power}"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("sides", no_wrap=True)
    rows = sorted(report.surfaces, key=lambda s: (not any(s.power), -s.area))  # emitters first, then by area
    for s in rows[:MOST_ROWS]:
        lit = any(s.power)
        table.add_row(
            Text(printable(s.name)),
            str(s.faces),
            f"{s.area:.4g}",
            _bands(s.reflectance),
            _bands(s.emission) if lit else "-",
            _bands(s.power) if lit else "-",
            s.sides,
        )
    return table


def _luminaires(luminaires, power_unit: str):
    """Return a table of luminaires: what they send, where they stand, and where they are aimed."""
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("luminaire", "group"):
        table.add_column(name, no_wrap=True)
    table.add_column(f"sends {power_unit}", justify="right", no_wrap=True)
    for name in ("position m", "direction", "luminous area m", "file"):
        table.add_column(name, no_wrap=True)
    for one in luminaires:
        length, width = one.size[:2]
        area = "-" if not length and not width else f"{length:.3g} x {width:.3g}{', round' if one.disc else ''}"
        area += ", soft" if one.soft else ""
        named = (Text(printable(text or "-")) for text in (one.name, one.group))
        facts = (_bands(one.power), _point(one.position), _point(one.axes[2].round(3) + 0.0), area)
        table.add_row(*named, *facts, Text(printable(one.source or "-")))
    return table


def _bands(values) -> str:
    """Return one number where all bands are equal, else all of them."""
    texts = [f"{v:.3g}" for v in values]
    return texts[0] if len(set(texts)) == 1 else " / ".join(texts)
