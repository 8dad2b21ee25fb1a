"""What a span of global lines costs, in local lines of the same scene: `spans()`."""

import time
from dataclasses import dataclass

import numpy as np
from history import note
from scenes import room

import radiosity as rd

# isort: split
import drjit as dr

from radiosity.algorithms.firing.counters import FiringCounters
from radiosity.algorithms.firing.due import due
from radiosity.algorithms.firing.fire import fire
from radiosity.device.backend import choose
from radiosity.problem.model import Problem
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.global_lines.spans import Spans

KINDS = ("global", "global-disc", "spans", "bundles")
LINES = 1 << 20  # of a turn
TURNS = 7
ROW = "{:<8} {:>7} {:>12} {:>8} {:>8} {:>8} {:>8}"


@dataclass(frozen=True)
class Cost:
    """Of a kind of lines: spans a line, million spans a second, and a span's cost in local lines of the same turn."""

    spans: float
    rate: float
    ratio: float


def spans() -> None:
    """Print the table."""
    print("spans of global lines, drawn to the host: their cost in local lines, which are fired in the same turn (medians)")
    print(ROW.format("scene", "faces", "kind", "a line", "M/s", "local", "ratio"))
    for tiles, cells in ((1, 24), (24, 1)):
        patches = rd.subdivide(room(tiles), cells=cells)
        local, costs = measure(patches)
        for kind, cost in costs.items():
            note(f"spans of {kind}, {patches.scene.n_faces} faces", cost.rate, "M/s")
            print(
                ROW.format(
                    "room",
                    patches.scene.n_faces,
                    kind,
                    f"{cost.spans:.2f}",
                    f"{cost.rate:.1f}",
                    f"{local:.1f}",
                    f"{cost.ratio:.2f}",
                ),
                flush=True,
            )


def measure(patches: rd.Patches, turns: int = TURNS, lines: int = LINES) -> tuple[float, dict[str, Cost]]:
    """Million local lines a second, and the cost of each kind's spans."""
    geometry = Geometry(patches, choose("cpu"))
    counters = FiringCounters(geometry, Problem.of(patches), rd.Method(), 0, 1)
    kinds = {kind: Spans(geometry, rd.Method(lines=kind, order="matrix"), 0, 1) for kind in KINDS}
    local, rates, each = [], {kind: [] for kind in KINDS}, {}
    for turn in range(turns + 1):
        counters.set_quanta((turn + 1) * lines)
        wavefront, largest = due(counters)
        assert wavefront is not None
        seconds, _ = _time(lambda wavefront=wavefront, largest=largest: fire(counters, wavefront, largest))
        found = {}
        for kind, source in kinds.items():
            took, pairs = _time(lambda source=source, turn=turn: source.draw(0, turn * lines, lines))
            each[kind] = len(pairs.line) / lines
            found[kind] = len(pairs.line) / took / 1e6
        if turn:  # the first compiles
            local.append(lines / seconds / 1e6)
            for kind, rate in found.items():
                rates[kind].append(rate)
    costs = {
        kind: Cost(each[kind], float(np.median(rate)), float(np.median(np.array(local) / np.array(rate))))
        for kind, rate in rates.items()
    }
    return float(np.median(local)), costs


def _time(work):
    dr.sync_thread()
    begun = time.perf_counter()
    result = work()
    dr.sync_thread()
    return time.perf_counter() - begun, result


if __name__ == "__main__":
    spans()
