"""`check`: what a scene holds, and what in it is probably not meant."""

import warnings
from dataclasses import dataclass

import numpy as np

from ..errors import RadiosityWarning, SceneError, shown
from . import leaks, topology
from .model import Back, Scene

SERIOUS, WARNING, NOTE = "error", "warning", "note"
SIDES = {Back.ABSORBS: "one", Back.RADIATES: "two", Back.PASSES: "one, clear from behind"}
LITTLE = 0.01  # of the lines: that much is lost on the backs of lamps in many sound scenes
BOX_SIDES = ("x low", "x high", "y low", "y high", "z low", "z high")


@dataclass(frozen=True)
class Finding:
    """Something to know about a scene: ``severity`` is "error", "warning" or "note"."""

    severity: str
    kind: str
    message: str


@dataclass(frozen=True)
class Surface:
    """Of one surface: faces; area of its radiating sides, m²; mean reflectance and exitance (W/m² or lm/m²) by band; sides; power by band."""

    name: str
    faces: int
    area: float
    reflectance: tuple[float, ...]
    emission: tuple[float, ...]
    power: tuple[float, ...]
    sides: str


@dataclass(frozen=True)
class Report:
    """What `check` found. ``scene`` is None where it could not be loaded."""

    source: str
    scene: Scene | None
    surfaces: tuple[Surface, ...]
    findings: tuple[Finding, ...]

    @property
    def serious(self) -> bool:
        """Something was found with which a solution would be worthless or impossible."""
        return any(finding.severity == SERIOUS for finding in self.findings)


def check_file(name, *, max_reflectance: float = 0.95, strict: bool = False, device: str = "auto") -> Report:
    """Load a scene and check it; what the reader says about the file is among the findings."""
    from . import load_scene

    findings = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RadiosityWarning)
        try:
            scene = load_scene(name, max_reflectance=max_reflectance, strict=strict)
        except SceneError as error:
            scene, findings = None, [Finding(SERIOUS, "file", str(error))]
    said = dict.fromkeys(str(w.message) for w in caught if issubclass(w.category, RadiosityWarning))
    findings = [Finding(WARNING, "file", text) for text in said] + findings
    if scene is None:
        return Report(str(name), None, (), tuple(findings))
    report = check(scene, device=device)
    return Report(str(name), scene, report.surfaces, (*findings, *report.findings))


def check(scene: Scene, *, walks: int = leaks.WALKS, seed: int = 0, device: str = "auto") -> Report:
    """Check a scene: geometry, materials, light, and by tracing lines where light gets lost.

    Raises:
        DeviceError: lines cannot be traced on this machine.
    """
    from ..patches import subdivide

    patches = subdivide(scene, cells=1)
    surfaces = _surfaces(patches)
    power = np.zeros((2, scene.n_faces))  # of fronts and backs, all bands together
    np.add.at(power, (patches.is_back.astype(int), patches.face), (patches.emission * patches.area[:, None]).sum(axis=1))
    findings = [*_values(patches), *_light(power), *_topology(scene), *_lines(scene, power, walks, seed, device)]
    for surface, front, back in leaks.flipped_emitters(scene, power[0] > 0, seed=seed, device=device):
        findings.append(Finding(SERIOUS, "flipped light", (
            f"light '{scene.names[surface]}' seems to face the wrong way: {_percent(front)} of the lines from its emitting side see the "
            f"scene, {_percent(back)} from behind; turn its faces round"
        )))  # fmt: skip
    return Report(scene.source, scene, surfaces, tuple(findings))


def _percent(share: float) -> str:
    return f"{100 * share:.3g} %"


def _surfaces(patches) -> tuple[Surface, ...]:
    scene, area = patches.scene, patches.area[:, None]
    rows = []
    faces = np.bincount(scene.surface, minlength=len(scene.names))

    def summed(values):
        return np.stack([np.bincount(patches.surface, column, len(scene.names)) for column in values.T], axis=1)

    total, reflected, power = summed(area)[:, 0], summed(patches.reflectance * area), summed(patches.emission * area)
    for i, name in enumerate(scene.names):
        if faces[i] == 0:
            continue
        kinds = [SIDES[Back(back)] for back in np.unique(scene.back[scene.surface == i])]
        rows.append(Surface(name, int(faces[i]), float(total[i]), tuple(reflected[i] / total[i]), tuple(power[i] / total[i]),
                            tuple(power[i]), " or ".join(kinds)))  # fmt: skip
    return tuple(rows)


def _values(patches):
    scene = patches.scene
    wrong = ~((patches.reflectance >= 0) & (patches.reflectance < 1)).all(axis=1)
    if wrong.any():
        names = [scene.names[s] for s in np.unique(patches.surface[wrong])]
        yield Finding(SERIOUS, "reflectance", f"reflectance outside [0, 1) on {shown(names)}; energy would grow at each reflection")
    empty = [name for i, name in enumerate(scene.names) if not (scene.surface == i).any()]
    if empty:
        yield Finding(WARNING, "empty surface", f"no face with an area in {shown(empty)}; a light among them emits nothing")


def _light(power: np.ndarray):
    if not power.any():
        yield Finding(SERIOUS, "no light", "no surface emits; give one an emission (Ke, an area emitter, ed, or emission in a .toml)")


def _topology(scene: Scene):
    one, two, same_way = topology.coincident(scene)
    double = same_way | (scene.back[one] == Back.RADIATES) | (scene.back[two] == Back.RADIATES)
    for pairs, text in (
        (double, "lie on another face and radiate to the same side; only one of the two gets light: remove the copies"),
        (~double, "lie back to back on another face, as the two sides of a thin wall"),
    ):
        if pairs.any():
            names = {scene.names[s] for s in scene.surface[np.concatenate([one[pairs], two[pairs]])]}
            severity = WARNING if pairs is double else NOTE
            yield Finding(severity, "duplicates", f"{int(pairs.sum())} faces (first: face {int(two[pairs][0])}) {text} ({shown(sorted(names))})")
    edges = topology.open_edges(scene)
    if len(edges.face):
        metres = np.bincount(scene.surface[edges.face], edges.length, len(scene.names))
        worst = [scene.names[s] for s in np.argsort(-metres) if metres[s] > 0]
        yield Finding(NOTE, "open edges", (
            f"{len(edges.face)} of {edges.total} edges ({edges.length.sum():.3g} m) belong to one face only, most on {shown(worst, 4)}; "
            "no harm in free-standing faces, and where a long edge meets several short ones"
        ))  # fmt: skip


def _lines(scene: Scene, power: np.ndarray, walks: int, seed: int, device: str):
    fates = leaks.follow(scene, power, walks, seed=seed, device=device)
    lines = len(fates.fate)
    if fates.escaped + fates.lost > 0.99:
        yield Finding(SERIOUS, "leaks", (
            f"{_percent(fates.escaped + fates.lost)} of {lines} lines meet no radiating side; are the normals turned round?"
        ))  # fmt: skip
        return
    for share, fate, severity, what, advice in (
        (fates.escaped, leaks.ESCAPED, WARNING, "leave the scene", "an open scene where the share is large, a crack where it is small"),
        (fates.lost, leaks.LOST, WARNING if fates.lost > LITTLE else NOTE, "land on absorbing backs", "if they should reflect, turn "
         "those faces round or make them two-sided"),
    ):  # fmt: skip
        if share > 0:
            where = _where(scene, fates, fates.fate == fate, fate)
            yield Finding(severity, "leaks", f"{_percent(share)} of {lines} lines {what} ({where}): {advice}")


def _where(scene: Scene, fates: leaks.Fates, gone: np.ndarray, fate: int) -> str:
    if fate == leaks.LOST:
        counts = np.bincount(scene.surface[fates.hit[gone]], minlength=len(scene.names))
        return "of " + _ranked(scene.names, counts)
    starts = np.bincount(scene.surface[fates.face[gone]], minlength=len(scene.names))
    ends = np.bincount(fates.exit[gone], minlength=6)
    return f"from {_ranked(scene.names, starts)}; through {_ranked(BOX_SIDES, ends)}"


def _ranked(names, counts: np.ndarray, most: int = 3) -> str:
    order = [i for i in np.argsort(-counts, kind="stable") if counts[i]][:most]
    return ", ".join(f"'{names[i]}' {100 * counts[i] / counts.sum():.0f} %" for i in order)
