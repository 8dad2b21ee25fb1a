"""Efficiency of workers of Dask: CPU seconds of one process with two threads over those of workers of one thread each.

    python benchmarks/cluster.py --lines 1e7 3e7 1e8 --replicates 8 1 -o cluster.jsonl
    python benchmarks/cluster.py --lines 1e8 --replicates 8 --workers 4   # more than cores: only CPU seconds tell something

CPU seconds and not wall time, since other programs may run on the machine; workers of equal speed that do not wait take half of
theirs each. Each figure is the least of some repetitions, taken in turns. The first run of each kind compiles kernels, and does
not count.
"""

import argparse
import json
import os
import time
from pathlib import Path

import numpy as np

import radiosity as rd
from radiosity.cluster import barrier, crew, post, wavefronts
from radiosity.cluster.connect import connected

SENT = {"Lines", "Hits", "Brought", "Outcome", "Share", "FiringState", "OwnRows"}  # values that hold arrays
SENT |= {"Shot", "Landed", "WalkState", "GatherLines"}  # of steps


def own_seconds() -> float:
    times = os.times()
    return times.user + times.system


class Counted:
    """The units that workers were given, and the bytes that went both ways."""

    def __init__(self):
        self.units = self.sent = self.received = 0
        for kind, taken in ((crew.DaskCrew, "_take"), (barrier.Barrier, "note")):
            self._count(kind, taken)

    def _count(self, kind, taken) -> None:
        submit, take = kind._submit, getattr(kind, taken)

        def counted_submit(this, what, *rest):
            self.units += 1
            self.sent += size(what)
            return submit(this, what, *rest)

        def counted_take(this, unit, outcome, *rest):
            self.received += size(outcome)
            return take(this, unit, outcome, *rest)

        kind._submit = counted_submit
        setattr(kind, taken, counted_take)

    def taken(self) -> dict[str, int]:
        found = {"units": self.units, "sent": self.sent, "received": self.received}
        self.units = self.sent = self.received = 0
        return found


def count_messages() -> None:
    """Count the messages that this worker sends to others, and their bytes."""
    deliver, counts = post.deliver, [0, 0]

    async def counted(worker, address, hits, message):
        counts[0] += 1
        counts[1] += 0 if hits is None else hits.nbytes
        await deliver(worker, address, hits, message)

    post.deliver, post.__dict__["messages"] = counted, counts


def messages() -> list[int]:
    return list(post.__dict__["messages"])


def size(value) -> int:
    """The bytes of all arrays within a value."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, dict):
        return sum(map(size, value.values()))
    if isinstance(value, (list, tuple)):
        return sum(map(size, value))
    return size(vars(value)) if type(value).__name__ in SENT else 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lines", type=float, nargs="+", default=[1e7, 1e8])
    parser.add_argument("--replicates", type=int, nargs="+", default=[8, 1])
    parser.add_argument("--barriers", action="store_true", help="let each wavefront of a cut replicate end with a barrier")
    parser.add_argument("--method", default="random-walk")
    parser.add_argument("--scene", default="room")
    parser.add_argument("--workers", type=int, default=2, help="where there are more than cores, each has one thread")
    parser.add_argument("--repeat", type=int, default=2)
    parser.add_argument("-o", "--output", type=Path)
    given = parser.parse_args()
    patches, counted = rd.subdivide(rd.load_scene(given.scene)), Counted()
    wavefronts.ROWS = len(patches) if given.barriers else wavefronts.ROWS
    with connected(f"local:{given.workers}") as client:
        client.run(count_messages)
        for replicates in given.replicates:
            measured(patches, client, counted, given.method, 1e6, replicates, 1)  # compiles kernels
            for lines in given.lines:
                row = measured(patches, client, counted, given.method, lines, replicates, given.repeat)
                print(json.dumps(row), flush=True)
                if given.output:
                    with given.output.open("a") as file:
                        file.write(json.dumps(row) + "\n")


def measured(patches, client, counted, method: str, lines: float, replicates: int, repeat: int) -> dict:
    alone, here, there, walls, waits, same = [], [], [], [], [], True
    options = {"rays": lines, "replicates": replicates, "method": method}
    for _ in range(repeat):
        begun, clock = own_seconds(), time.perf_counter()
        one = rd.solve(patches, **options)
        alone.append(own_seconds() - begun)
        walls.append(time.perf_counter() - clock)
        begun, before = own_seconds(), sum(client.run(own_seconds).values())
        counted.taken()
        posted = np.sum(list(client.run(messages).values()), axis=0)
        clock = time.perf_counter()
        other = rd.solve(patches, **options, cluster=client)
        waits.append(time.perf_counter() - clock)
        same &= one.radiosity.tobytes() == other.radiosity.tobytes()
        units = counted.taken()
        more = np.sum(list(client.run(messages).values()), axis=0) - posted
        units |= {"messages": int(more[0]), "bytes of messages": int(more[1])}
        here.append(own_seconds() - begun)
        there.append(sum(client.run(own_seconds).values()) - before)
    best = int(np.argmin(np.add(here, there)))
    return {
        "scene": patches.scene.source,
        "patches": len(patches),
        "lines": lines,
        "method": method,
        "replicates": replicates,
        "workers there": len(client.nthreads()),
        "barriers": len(patches) == wavefronts.ROWS,
        "same bits": same,
        "alone": round(min(alone), 2),
        "driver": round(here[best], 2),
        "workers": round(there[best], 2),
        "efficiency": round(min(alone) / (here[best] + there[best]), 3),
        "efficiency of workers": round(min(alone) / there[best], 3),
        "wall alone": round(min(walls), 1),
        "wall": round(waits[best], 1),
        **units,
    }


if __name__ == "__main__":
    main()
