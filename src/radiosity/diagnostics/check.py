"""The findings of `check`: what a scene holds, and what in it is probably not meant."""

import warnings

import numpy as np

from ..errors import RadiosityWarning, SceneError, shown
from ..scene import topology
from ..scene.model import Scene
from . import contact_findings, dark_sides, leaks, luminaire_findings, near_lamps
from .report import NOTE, SERIOUS, WARNING, Finding, Report, surface_rows

LITTLE = 0.01  # of the lines: in many correct scenes, backs of lamps absorb that much
BOX_SIDES = ("lowest x", "highest x", "lowest y", "highest y", "lowest z", "highest z")


def check_file(
    name, *, max_reflectance: float = 0.95, strict: bool = False, allow_outside: bool = False, device: str = "auto"
) -> Report:
    """Load a scene and check it; the reader's warnings about the file are among the findings."""
    from ..scene import load_scene

    findings = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RadiosityWarning)
        try:
            scene = load_scene(name, max_reflectance=max_reflectance, strict=strict, allow_outside=allow_outside)
        except SceneError as error:
            scene, findings = None, [Finding(SERIOUS, "file", str(error))]
    said = dict.fromkeys(str(w.message) for w in caught if issubclass(w.category, RadiosityWarning))
    findings = [Finding(WARNING, "file", text) for text in said] + findings
    if scene is None:
        return Report(str(name), None, (), tuple(findings))
    report = check(scene, device=device)
    return Report(str(name), scene, report.surfaces, (*findings, *report.findings))


def check(scene: Scene, *, walks: int = leaks.WALKS, seed: int = 0, device: str = "auto") -> Report:
    """Check a scene: geometry, materials, light, and, by tracing lines, where light is lost.

    Args:
        scene: what `load_scene` gave, or a scene of arrays.
        walks: how many lines look for leaks.
        seed: with the same scene, the same findings.
        device: "auto", "cpu" or "cuda".

    Returns:
        A report with ``findings`` (each has ``severity``, ``kind`` and ``message``), ``surfaces`` and ``serious``: True where a
        solution would be worthless or impossible.

    Raises:
        DeviceError: lines cannot be traced on this machine.

    Example:
        >>> report = rd.check(rd.load_scene("room"))
        >>> report.serious
        False
    """
    from ..patches import subdivide

    patches = subdivide(scene, cells=1)
    power = np.zeros((2, scene.n_faces))  # emitted by fronts and backs, all bands together
    np.add.at(power, (patches.is_back.astype(int), patches.face), (patches.emission * patches.area[:, None]).sum(axis=1))
    from_lights, of_luminaires = luminaire_findings.first_light(scene, seed, device)
    findings = [*_values(patches), *_light(scene, power), *_topology(scene), *of_luminaires]
    findings += _lines(scene, power + from_lights, walks, seed, device)
    near = near_lamps.near_lamps(subdivide(scene), device)
    if near is not None:
        findings.append(Finding(WARNING, "near lamps", near_lamps.told(near)))
    for surface, front, back in leaks.flipped_emitters(scene, (power[0] > 0) & (power[1] == 0), seed=seed, device=device):
        text = f"{_percent(front)} of the lines from its emitting side see the scene, {_percent(back)} from behind"
        name = scene.names[surface]
        findings.append(
            Finding(SERIOUS, "flipped light", f"light '{name}' seems to face the wrong way: {text}; turn its faces round")
        )
    return Report(scene.source, scene, surface_rows(patches), tuple(findings))


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"


def _values(patches):
    scene = patches.scene
    wrong = ~((patches.reflectance >= 0) & (patches.reflectance < 1)).all(axis=1)
    if wrong.any():
        names = [scene.names[s] for s in np.unique(patches.surface[wrong])]
        text = f"reflectance outside [0, 1) on {shown(names)}; energy would grow at each reflection"
        yield Finding(SERIOUS, "reflectance", text)
    empty = [scene.names[i] for i in np.flatnonzero(np.bincount(scene.surface, minlength=len(scene.names)) == 0)]
    if empty:
        yield Finding(WARNING, "empty surface", f"no face with an area in {shown(empty)}; a light among them emits nothing")


def _light(scene: Scene, power: np.ndarray):
    if not power.any() and not scene.lights:
        text = "no surface emits; give one an emission: Ke, an area emitter, ed, or power or [[luminaire]] in a .toml"
        text += " (docs/scene-toml.md)"
        yield Finding(SERIOUS, "no light", text)


def _topology(scene: Scene):
    yield from contact_findings.findings(scene)
    edges = topology.open_edges(scene)
    if len(edges.face):
        metres = np.bincount(scene.surface[edges.face], edges.length, len(scene.names))
        ranks = np.round(metres / metres.max(), 6)  # equal lengths in the order of surfaces, wherever they lie
        worst = [scene.names[s] for s in np.argsort(-ranks, kind="stable") if metres[s] > 0]
        count = f"{len(edges.face)} of {edges.total} edges ({edges.length.sum():.3g} m) belong to one face only"
        harmless = "no harm in free-standing faces, and where a long edge meets several short ones"
        yield Finding(NOTE, "open edges", f"{count}, most on {shown(worst, 4)}; {harmless}")


def _lines(scene: Scene, power: np.ndarray, walks: int, seed: int, device: str):
    followed = leaks.follow(scene, power, walks, seed=seed, device=device)
    fates = dark_sides.inside(scene, followed)
    lines = len(fates.fate)
    outside = scene.lights.sky is not None or bool(scene.lights.suns)  # lines then leave to where light comes from
    if fates.escaped + fates.lost > 0.99 and not (outside and fates.escaped > fates.lost):
        gone = _percent(fates.escaped + fates.lost)
        yield Finding(SERIOUS, "leaks", f"{gone} of {lines} lines meet no radiating side; are the normals turned round?")
        return
    if fates.escaped:
        where, advice = _escapes(scene, fates), "an open scene where the share is large, a crack where it is small"
        if outside:
            advice = "where the sky and the sun shine in, or a crack where the share is small"
        text = f"{_percent(fates.escaped)} of {lines} lines leave the scene ({where}): {advice}"
        yield Finding(NOTE if outside else WARNING, "leaks", text)
    if fates.lost:
        counts = np.bincount(scene.surface[fates.hit[fates.fate == leaks.LOST]], minlength=len(scene.names))
        where = _ranked(_quoted(scene.names), counts)
        advice = "if they should reflect, turn those faces round or make them two-sided"
        severity = WARNING if fates.lost > LITTLE else NOTE
        text = f"{_percent(fates.lost)} of {lines} lines hit absorbing backs (of {where}): {advice}"
        yield Finding(severity, "leaks", text)
    yield from dark_sides.findings(scene, followed, power)


def _escapes(scene: Scene, fates: leaks.Fates) -> str:
    gone = fates.fate == leaks.ESCAPED
    starts = np.bincount(scene.surface[fates.face[gone]], minlength=len(scene.names))
    ends = np.bincount(fates.exit[gone], minlength=6)
    return f"from {_ranked(_quoted(scene.names), starts)}; out at the scene's {_ranked(BOX_SIDES, ends)}"


def _quoted(names) -> list[str]:
    return [f"'{name}'" for name in names]


def _ranked(names, counts: np.ndarray, most: int = 3) -> str:
    order = [i for i in np.argsort(-counts, kind="stable") if counts[i]][:most]
    return ", ".join(f"{names[i]} {100 * counts[i] / counts.sum():.0f} %" for i in order)
