"""The choice of a method for a scene: ``method="auto"``.

A pilot traces a few lines of every patch (`algorithms.gather.pilot`). It tells the variance of the lines of a gather, and a rough
solution, from which the errors of a random walk and of iterations with a control variate follow. The least error for equal work
is taken, by a table of costs; no clock is read. With a basis the walk is that of particles, and errors are those of all
coefficients together. So the choice is a function of the scene, the seed and the budget in lines or
quanta. Quanta replay a run with the method that was chosen, which the solution holds.
"""

from dataclasses import dataclass, field, replace

import numpy as np

from ..algorithms.gather import pilot
from ..algorithms.gather.chances import CLUSTER, Chances
from ..algorithms.gather.lines import UNITS, most_read
from ..device.backend import choose
from ..diagnostics.lamps_at_faces import spots
from ..errors import MethodError
from ..method import Auto, Method
from ..method.auto import FALLBACK, NAME
from ..method.presets import PRESETS
from ..patches import Patches
from ..patches.bases import BASES
from ..problem.model import Problem
from ..scene.model import Back
from ..solution.model import Solution
from ..tally.unmet import sides
from ..tracing.geometry import Geometry
from .budget import Budget
from .part import Part

CONTROL = "stochastic-jacobi-control-variate"
PARTICLES = "particle-tracing"  # the walk that takes a basis
METHODS = {  # and what it takes besides its name
    "gather": {},
    FALLBACK: {},
    PARTICLES: {},
    CONTROL: {"estimator": "bidirectional"},
}
# CPU time of a line relative to a random walk's, and what measured errors are relative to predicted ones: 2 cores, ten scenes;
# with a basis errors of four scenes (room, rooms, cornell-box, labyrinth-0.5), and times of two
COSTS = {
    "constant": {"gather": 1.1, FALLBACK: 1.0, CONTROL: 1.8},
    "linear": {"gather": 1.15, PARTICLES: 1.35, CONTROL: 2.2},
    "quadratic": {"gather": 1.3, PARTICLES: 1.5, CONTROL: 2.9},
}
MEASURED = {
    "constant": {"gather": 0.75, FALLBACK: 1.1, CONTROL: 1.2},
    "linear": {"gather": 0.6, PARTICLES: 0.9, CONTROL: 1.6},
    "quadratic": {"gather": 0.65, PARTICLES: 0.93, CONTROL: 2.9},
}
EVENEST = {"constant": 0.0, "linear": 0.04, "quadratic": 0.13}  # share of the noise that a control variate leaves in even light
ENOUGH = {"constant": 48, "linear": 112, "quadratic": 240}  # lines of a patch: with fewer, a pilot takes too much of them
ENTRY = 4.0  # lines: the work of one entry of the table of clusters and lamps
MOST = 0.3  # of the lines: the work of the pilot
TINY = 1e-6  # of the light: smaller errors count as this
ROUNDED = 1e-3  # of the reflected light: a gather that would round by more is not taken
UNKNOWN = 3e7  # lines: the work of a pilot that is done where seconds or an error are asked for


@dataclass(frozen=True)
class Choice:
    """A chosen method.

    Attributes:
        method: what to solve with.
        facts: what the provenance holds: the name, why it was chosen, and lines of the pilot that the method does not count.
        geometry: the scene on the device, where the pilot has made it.
        seconds: what it took to choose; they are seconds of the run.
    """

    method: Method
    facts: dict
    geometry: Geometry | None = field(default=None, repr=False)
    seconds: float = 0.0

    @property
    def extra_lines(self) -> int:
        return int(self.facts.get("pilot_lines", 0))


def choice_for(auto: Auto, patches: Patches, budget: Budget, part: Part, device: str, resume: Solution | None) -> Choice:
    """Choose the method of a run; one that goes on takes that of its solution.

    Raises:
        MethodError: no method takes the basis and the scene, or the solution to go on from has another basis.
    """
    if resume is not None:
        return _of_solution(auto, resume)
    problem, n, basis = Problem.of(patches), len(patches), auto.basis
    if basis != "constant" and problem.lights is not None:
        return _with_lights(patches, basis)
    walk = FALLBACK if basis == "constant" else PARTICLES
    reason = _impossible(patches)
    if not reason:
        entries = -(-n // CLUSTER) * _lamps(patches)
        reason = _too_few(budget, part, n, pilot.LINES * n + ENTRY * entries, ENOUGH[basis] + pilot.LINES)
    if reason:
        return _chosen(walk, basis, reason, 0)
    if problem.lights is not None:
        near = spots(patches)
        if near:
            why = (
                f"luminaire '{near[0].luminaire}' is {near[0].distance:.3g} m from '{near[0].surface}', too near for shadow rays"
            )
            return _chosen(walk, basis, why, 0)
        return _chosen("gather", basis, "shadow rays go to lights without area", 0)
    geometry = Geometry(problem.patches, choose(device))
    geometry.prepare()
    method = replace(PRESETS["gather"].method, basis=basis)
    found = pilot.Pilot.of(geometry, problem, Chances.of(geometry, problem), method, part.seed)
    errors = predicted(problem, found, basis)
    if not errors:
        return _chosen(walk, basis, "the pilot met no light that is reflected", pilot.LINES * n, geometry)
    rounded = rounding(problem, found)
    if rounded > ROUNDED:
        why = f"lamps are so small and bright that a gather would round the light by {rounded:.2g} of it"
        return _chosen(walk, basis, why, pilot.LINES * n, geometry)
    order = sorted(errors, key=lambda name: errors[name])
    best, least = order[0], max(errors[order[0]], TINY)
    shown = ", ".join(f"{name} {max(errors[name], TINY) / least:.3g}" for name in order)
    counted = 0 if best == "gather" else pilot.LINES * n
    return _chosen(best, basis, f"predicted errors for equal work: {shown}", counted, geometry)


def predicted(problem: Problem, found: pilot.Pilot, basis: str = "constant") -> dict[str, float]:
    """Return the relative error of each method that takes a basis after one line of every patch, times the root of its cost.

    It is empty where the pilot met no light that is reflected. With a basis of K functions it is the error of all coefficients:
    that of a hit is about K times the error of its mean, since functions have the mean square 1. The pilot's variance of a gather
    holds all coefficients.
    """
    area, groups, n = problem.patches.area, problem.groups, len(problem.patches)
    shares = groups.emission / np.maximum(problem.unit, 1e-300)
    reflected = groups.scatter.of(found.irradiance)
    group = int(np.argmax((area[:, None] * reflected**2).sum(axis=0)))
    light, rho = reflected[:, group], groups.scatter.albedo[:, group]
    total = float(area @ light**2)
    if not total:
        return {}
    packets = found.shares.packets
    weights = np.repeat(found.shares.weights, packets.sizes, axis=1)[:, packets.place]
    each = n * weights / weights.sum()
    importance = area * groups.scatter.albedo.max(axis=1) ** 2
    gather = float((importance * found.variance / each).sum()) / total
    power, again = float(area @ shares.max(axis=1)), float(area @ reflected.max(axis=1))
    walk = float(rho @ light) * (power + again) / n / total
    left = shares[:, group] + light
    order = np.argsort(left)
    middle = left[order][np.searchsorted(np.cumsum(area[order]), area.sum() / 2)]
    even = float(area @ np.abs(left - middle)) / float(area @ left)
    walk *= BASES[basis].size
    squares = {"gather": gather, FALLBACK: walk, PARTICLES: walk, CONTROL: walk * max(even, EVENEST[basis]) ** 2}
    costs, measured = COSTS[basis], MEASURED[basis]
    return {name: measured[name] * (costs[name] * max(squares[name], 0.0)) ** 0.5 for name in costs}


def rounding(problem: Problem, found: pilot.Pilot) -> float:
    """Return half of a unit in which cosine lines of a gather count, over the RMS of the reflected light of patches.

    A unit is a share of the brightest lamp's exitance. Light that is less than half of one counts as none.
    """
    area, albedo = problem.patches.area, problem.groups.scatter.albedo.max(axis=1)
    light = found.irradiance.max(axis=1) * albedo
    return most_read(problem) / (2 * UNITS) / max(float(area @ light**2 / area.sum()) ** 0.5, 1e-300)


def _impossible(patches: Patches) -> str:
    passes = np.isin(patches.scene.back, (Back.PASSES, Back.OPEN)).any()
    return "lines pass through some backs, which only random walks follow" if passes else ""


def _lamps(patches: Patches) -> int:
    return len(np.unique(sides(patches)[patches.emission.any(axis=1)]))


def _too_few(budget: Budget, part: Part, n: int, work: float, enough: int) -> str:
    replicates = part.in_all or part.replicates
    if budget.quanta is not None:
        lines = float(budget.quanta) * replicates + pilot.LINES * n
    elif budget.rays is not None:
        lines = budget.rays
    else:
        return "" if work <= UNKNOWN else f"a pilot would take the work of {work:.2g} lines"
    if lines < enough * n:
        return f"fewer than {enough} lines a patch"
    return "" if work <= MOST * lines else f"a pilot would take the work of {work:.2g} lines"


def _with_lights(patches: Patches, basis: str) -> Choice:
    """Choose for a basis and lights without area, which only a gather takes together.

    Raises:
        MethodError: it does not take the backs of the scene.
    """
    reason = _impossible(patches)
    if reason:
        raise MethodError(
            f"{patches.scene.source}: {reason}, there are lights without area, and no method takes both with basis '{basis}': "
            "leave basis out, or let the backs absorb light"
        )
    return _chosen("gather", basis, f"basis '{basis}', and shadow rays go to lights without area", 0)


def _chosen(name: str, basis: str, why: str, lines: int, geometry: Geometry | None = None) -> Choice:
    method = Method(**{**PRESETS[name].method.choices, **METHODS[name], "basis": basis})
    return Choice(method, {"chosen": name, "why": why, "pilot_lines": lines}, geometry)


def _of_solution(auto: Auto, resume: Solution) -> Choice:
    choices = resume.provenance.get("choices")
    try:
        if resume.by_baseline:
            raise TypeError
        method = Method(**dict(choices or {}))
    except TypeError:
        raise MethodError(f"method {NAME} cannot go on from a solution by {resume.provenance.get('method')}; name it") from None
    if auto.basis not in ("constant", method.basis):
        raise MethodError(
            f"basis is '{auto.basis}', and the solution to go on from has basis '{method.basis}': leave basis out, or start anew"
        )
    return Choice(method, dict(resume.provenance.get(NAME) or {}))
