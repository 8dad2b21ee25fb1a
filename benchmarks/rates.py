"""Our lines a second, and those of Mitsuba's bare ray caster on the same rays, in turn."""

import time
from dataclasses import dataclass

import radiosity as rd  # first: it points Dr.Jit to a libLLVM

# isort: split
import drjit as dr

from radiosity.algorithms.firing.counters import FiringCounters
from radiosity.algorithms.firing.due import due
from radiosity.algorithms.firing.fire import batches, fire
from radiosity.device.backend import choose, entered
from radiosity.problem.model import Problem
from radiosity.tracing.geometry import Geometry

LINES = 1 << 22  # of a sweep
TURNS = 7


@dataclass(frozen=True)
class Rates:
    """Million lines a second: the best of all turns; and the median ratio of ours to the bare caster's, turn by turn."""

    ours: float
    bare: float
    ratio: float


def measure(
    patches: rd.Patches, *, coherent: bool | str = False, lines: int = LINES, turns: int = TURNS, device: str = "cpu"
) -> Rates:
    """Time whole sweeps (what is owed, lanes, numbers, lines, hits, tally) of black patches against the bare caster."""
    geometry = Geometry(patches, choose(device))
    counters = FiringCounters(geometry, Problem.of(patches), rd.Method(coherent=coherent), 0, 1)
    rays, width = _rays(counters, lines)
    ours, bare, quanta = [], [], lines
    for turn in range(turns + 1):
        quanta += lines
        counters.set_quanta(quanta)
        one = _time(lambda: fire(counters, *due(counters)))
        two = _time(lambda: _bare(geometry, rays))
        if turn:  # the first compiles
            ours.append(lines / one / 1e6)
            bare.append(width / two / 1e6)
    ratios = sorted(a / b for a, b in zip(ours, bare, strict=True))
    return Rates(max(ours), max(bare), ratios[len(ratios) // 2])


def _rays(counters: FiringCounters, lines: int):
    """The rays of the first sweep, in memory, in the order in which they are fired."""
    types = counters.types
    counters.set_quanta(lines)
    wavefront, largest = due(counters)
    bits = counters.tracer.numbers.bits_for(largest)
    parts, total = [], 0
    for launch in (launch for batch in batches(counters, wavefront) for launch in batch.launches(types)):
        number, index, record = launch.read(types)
        points = counters.tracer.points(number, index, dr.zeros(types.UInt32, launch.width), record, bits)
        ray = counters.tracer.leave(record)(points)
        dr.eval(ray)
        parts.append(ray)
        total += launch.width
    dr.sync_thread()
    fire(counters, wavefront, largest)
    return parts, total


def _bare(geometry: Geometry, rays) -> None:
    with entered(geometry.device) as mi:
        for origin, direction in rays:
            ray = mi.Ray3f(mi.Point3f(origin), mi.Vector3f(direction))
            hit = geometry.bvh.scene.ray_intersect_preliminary(ray, coherent=False)
            dr.eval(hit.t, hit.prim_index, hit.prim_uv)


def _time(work) -> float:
    dr.sync_thread()
    begun = time.perf_counter()
    work()
    dr.sync_thread()
    return time.perf_counter() - begun
