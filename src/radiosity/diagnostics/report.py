"""The report of `check`: findings, and a table of surfaces."""

from dataclasses import dataclass

import numpy as np

from ..scene.model import Back, Scene

SERIOUS, WARNING, NOTE = "error", "warning", "note"
SIDES = {Back.ABSORBS: "one", Back.RADIATES: "two", Back.PASSES: "one, clear from behind", Back.OPEN: "one, clear on both"}


@dataclass(frozen=True)
class Finding:
    """A finding about a scene; ``severity`` is "error", "warning" or "note"."""

    severity: str
    kind: str
    message: str


@dataclass(frozen=True)
class Surface:
    """A row of the table.

    Attributes:
        name: of the surface.
        faces: the number of its faces.
        area: of its radiating sides, m².
        reflectance, emission: area means by band; emission is exitance, W/m² or lm/m².
        power: emitted power by band, W or lm.
        sides: its sides in words.
    """

    name: str
    faces: int
    area: float
    reflectance: tuple[float, ...]
    emission: tuple[float, ...]
    power: tuple[float, ...]
    sides: str


@dataclass(frozen=True)
class Report:
    """The findings and the table of `check`. ``scene`` is None where it could not be loaded."""

    source: str
    scene: Scene | None
    surfaces: tuple[Surface, ...]
    findings: tuple[Finding, ...]

    @property
    def serious(self) -> bool:
        """True where a solution would be worthless or impossible."""
        return any(finding.severity == SERIOUS for finding in self.findings)


def surface_rows(patches) -> tuple[Surface, ...]:
    """Return the rows of the table, from one patch for each face and radiating side; surfaces without faces are left out."""
    scene, area = patches.scene, patches.area[:, None]
    through = scene.transmittance
    n = len(scene.names)

    def summed(values):
        return np.stack([np.bincount(patches.surface, column, n) for column in values.T], axis=1)

    faces, total = np.bincount(scene.surface, minlength=n), summed(area)[:, 0]
    reflected, power = summed(patches.reflectance * area), summed(patches.emission * area)
    kinds = {back: np.bincount(scene.surface[scene.back == back], minlength=n) > 0 for back in Back}
    rows = []
    for i in np.flatnonzero(faces):
        sides = " or ".join(SIDES[back] for back in Back if kinds[back][i])
        if through is not None and through[scene.surface == i].any():
            sides += f"; a pane, {through[scene.surface == i].max():.3g} clear"
        if scene.diffusers[scene.surface == i].any():
            sides += f"; diffuses up to {scene.diffuse_transmittance[scene.surface == i].max():.3g}"
        means = tuple(reflected[i] / total[i]), tuple(power[i] / total[i])
        rows.append(Surface(scene.names[i], int(faces[i]), float(total[i]), *means, tuple(power[i]), sides))
    return tuple(rows)
