"""What luminaires light first: those whose light meets absorbing backs, or nothing, stand where they are hardly meant to."""

import numpy as np

from ..errors import shown
from ..scene.lights.luminaire import Luminaire
from ..scene.model import Back, Scene
from ..scene.precision import OFFSET
from .report import WARNING, Finding

LINES = 256  # of each luminaire
MOST_BEHIND, MOST_GONE = 0.5, 0.9  # of its lines: where more meet backs, or leave the scene, it is named
NEAR = 0.05  # metres: what is closer may be a housing
FRONT = "Move it in front, or leave that out"
GRID = 360  # entries along each angle of the table that directions are drawn from


def first_light(scene: Scene, seed: int, device: str) -> tuple[np.ndarray, list[Finding]]:
    """Return the power that fronts and backs receive from luminaires, (2, n_faces), all bands together, and findings."""
    luminaires = scene.lights.luminaires
    received = np.zeros((2, scene.n_faces))
    if not luminaires:
        return received, []
    from ..tracing.first_hits import first_hits  # the tracer takes a while to start

    generator = np.random.Generator(np.random.Philox(seed))
    directions = np.concatenate([_directions(one, generator) for one in luminaires])
    places = np.repeat([_place(one, scene) for one in luminaires], LINES, axis=0)
    hits = first_hits(scene, places, directions, device=device)
    lost = (hits.face >= 0) & ~hits.front & (scene.back[hits.face] != Back.RADIATES)
    seen = (hits.face >= 0) & ~lost
    power = np.repeat([one.power.sum() / LINES for one in luminaires], LINES)
    np.add.at(received, ((~hits.front[seen]).astype(int), hits.face[seen]), power[seen])
    findings = []
    behind, housing = "do they stand behind a ceiling, or inside a box? " + FRONT, "is it inside of its housing? " + FRONT
    aimed = "are they aimed as they should be? -z is down by default"
    for gone, most, what, advice in (
        (lost, MOST_BEHIND, "meets absorbing backs", behind),
        (seen & (hits.distance < NEAR), MOST_BEHIND, f"meets a surface within {100 * NEAR:g} cm", housing),
        (hits.face < 0, MOST_GONE, "leaves the scene", aimed),
    ):
        shares = gone.reshape(-1, LINES).mean(axis=1)
        named = [luminaires[i].name for i in np.flatnonzero(shares > most)]
        if named:
            text = f"most of the light of {shown(named)} {what} ({100 * shares[shares > most].mean():.0f} %): {advice}"
            findings.append(Finding(WARNING, "luminaires", text))
    return received, findings


def _place(one: Luminaire, scene: Scene) -> np.ndarray:
    """Return where its lines begin, metres, in front of a face that it is let into."""
    return one.position + one.axes[2] * OFFSET * max(np.abs(one.position - scene.centre).max(), 1e-6 * scene.reach)


def _directions(one: Luminaire, generator: np.random.Generator) -> np.ndarray:
    """Return directions in proportion to its web, (LINES, 3), from the middles of a grid of C and gamma."""
    web = one.web
    gamma = np.radians(np.linspace(web.gamma[0], web.gamma[-1], 2 * GRID + 1)[1::2])
    planes = np.radians((np.arange(GRID) + 0.5) * 360 / GRID)
    rows = np.stack([np.interp(np.degrees(gamma), web.gamma, row, left=0, right=0) for row in web.intensity])
    if len(rows) > 1:
        rows = np.stack([np.interp(np.degrees(planes), web.planes, column) for column in rows.T], axis=1)
    share = np.cumsum(np.broadcast_to(rows, (GRID if len(rows) > 1 else 1, GRID)) * np.sin(gamma))
    at = (np.arange(LINES) + generator.random(LINES)) / LINES * share[-1]
    cell = np.minimum(np.searchsorted(share, at, side="right"), len(share) - 1)
    g = gamma[cell % GRID]
    c = planes[cell // GRID] if len(rows) > 1 else 2 * np.pi * generator.random(LINES)
    local = np.stack([np.cos(c) * np.sin(g), np.sin(c) * np.sin(g), np.cos(g)], axis=1)
    return local @ one.axes
