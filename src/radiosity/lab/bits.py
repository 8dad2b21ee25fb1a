"""Hashes which show that the integers of a run do not depend on how it is run (contract 2); not in the paper."""

import hashlib
from dataclasses import dataclass

import numpy as np

from ..device.backend import threads
from ..method import Method
from ..run.solve import solve
from .study import Case

QUANTA = 200_000


@dataclass(frozen=True)
class Bits:
    """The hash of one way to run.

    Attributes:
        how: the way in words.
        digest: hash of the hit counts and fired counts of all replicates.
    """

    how: str
    digest: str


def bits(case: Case, seed: int) -> list[Bits]:
    """Return hashes over orders, numbers of threads and numbers of stages; and of another seed, whose hash must differ."""
    rows: list[Bits] = []

    def row(how: str, solution) -> None:
        state = solution.state
        joined = b"".join(np.ascontiguousarray(state[name]).tobytes() for name in ("arrivals", "fired", "missed"))
        rows.append(Bits(how, hashlib.sha256(joined).hexdigest()[:16]))

    for order in ("depth-first", "breadth-first", "staged", "well-distributed"):
        row(order, solve(case.patches, Method(order=order), quanta=QUANTA, replicates=2, seed=seed))
    for count in (1, 2, 4):
        with threads(count):
            found = solve(case.patches, Method(), quanta=QUANTA, replicates=2, seed=seed)
        row(f"breadth-first, {count} thread{'s' if count > 1 else ''}", found)
    for stages in (2, 5):
        solution = None
        for stage in range(1, stages + 1):
            solution = solve(case.patches, Method(), quanta=QUANTA * stage // stages, replicates=2, seed=seed, resume=solution)
        row(f"breadth-first, {stages} stages", solution)
    row("another seed", solve(case.patches, Method(), quanta=QUANTA, replicates=2, seed=seed + 1))
    return rows
