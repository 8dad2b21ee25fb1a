"""The lines that send the residue on, and the walks that they begin (see `residue`), outside the hit and fired counts.

A line of weight 1 goes on from its hit with its weight times the reflectance. Where that falls below `LEAST`, it goes on with
this weight or ends. Absorption by chance alone would add noise to what the scene receives where it reflects nearly all.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import frozen, upload
from ...device.launches import shared
from ...device.recorded import loop
from ...pieces import pieces
from ...problem.bands import QUANTUM
from ...problem.model import Problem
from ...sampling.numbers import WORDS
from ...sampling.numbers.random import philox
from ...sampling.streams import Purpose, stream
from ...solution.books import exact_totals, signed_totals
from .counters import FiringCounters
from .residue import Starts
from .state import FiringState

LEAST = QUANTUM // 2  # 2^30
LONGER = 1.6  # ratio to the lines that chance alone would take, 1.5 to 1.7 where reflectances are 0.5 to 1


@dataclass(frozen=True, eq=False)
class Sent:
    """The power that residues add to the received power, in 64-bit fixed point, `QUANTUM` to a quantum. It may be negative.

    Attributes:
        received: (replicates, n_patches, n_groups) int64, received power with that of the residue; float64 where it may have more
            than 63 bits.
        missed: (2, replicates, n_groups) int64, escaped and lost power of the residue alone.
        fired: n_groups whole numbers, power of the residue that left patches along lines, of all replicates.
        lines: lines of the residue, of all replicates.
        residue: (replicates, n_patches, n_groups) int64, received power of the residue alone, where ``received`` is rounded.
    """

    received: np.ndarray
    missed: np.ndarray
    fired: list[int]
    lines: int
    residue: np.ndarray | None = None

    def totals(self, state: FiringState, group: int, albedo: np.ndarray) -> tuple[int, int]:
        """Return the sum of the received power of a group, and of its products with (n_patches,) uint32, without rounding."""
        if self.residue is None:
            return signed_totals(self.received[..., group], albedo)
        total, weighted = signed_totals(self.residue[..., group], albedo)
        if state.bands is None:
            more, of_more = (x * QUANTUM for x in exact_totals(state.arrivals, albedo))
        else:
            more, of_more = state.bands.totals("received", (..., group), albedo)
        return total + more, weighted + of_more


def starts(counters: FiringCounters, problem: Problem, state: FiringState) -> Starts:
    """Return the lines of the residue after the state's stage."""
    tracer = counters.tracer
    return Starts.of(problem, state, frozen(counters.targets.phase).reshape(tracer.replicates, tracer.n), tracer.seed)


def send(counters: FiringCounters, problem: Problem, state: FiringState, begun: Starts) -> Sent:
    """Send the residues of a complete stage on.

    Args:
        counters: the counters of the run, which do not change.
        problem: the problem to solve.
        state: the state of the stage.
        begun: its `starts`.
    """
    tracer, n_groups = counters.tracer, begun.power.shape[1]
    tally = dr.zeros(counters.types.Int64, tracer.slots * n_groups)
    dr.eval(tally)
    fired, lines = _walk(counters, begun, tally) if len(begun.line) else ([0] * n_groups, 0)
    flat = frozen(tally).reshape(-1, n_groups)  # there is no other reference: hits are added in place, without a copy
    received = residue = flat[: tracer.total].reshape(tracer.replicates, tracer.n, n_groups)
    rounded = _beyond(state)
    if rounded:
        received = residue.astype(np.float64)
    for replicate, row in enumerate(received):
        for part in pieces(tracer.n):
            if state.bands is not None:
                row[part] += state.bands.about("received", (replicate, part)).astype(received.dtype)
            else:
                row[part] += (state.arrivals[replicate, part] * received.dtype.type(QUANTUM))[:, None]
    missed = flat[tracer.total :].reshape(2, tracer.replicates, n_groups)
    return Sent(received, missed, fired, lines, residue if rounded else None)


def _beyond(state: FiringState) -> bool:
    """Return whether received power may have more than 62 bits."""
    if state.bands is not None:
        return state.bands.received_upper is not None or int(state.bands.received.max()) >> 62 > 0
    return int(state.arrivals.max()) * QUANTUM >> 62 > 0


def _walk(counters: FiringCounters, begun: Starts, tally) -> tuple[list[int], int]:
    """Follow the walk of each line to its end, one lane a line, in one kernel.

    Returns the power that was fired, of each group, and the number of lines.
    """
    types, tracer, (m, n_groups) = counters.types, counters.tracer, begun.power.shape
    width = max(m, 2)  # arrays of one entry would compile a kernel of their own

    def column(kind, values):
        return upload(kind, np.resize(values, width))

    number = column(types.UInt32, (begun.replicate * tracer.n + begun.patch).astype(np.uint32))
    line, going = column(types.UInt32, begun.line), dr.arange(types.UInt32, width) < dr.opaque(types.UInt32, m)
    streams = [stream(tracer.seed, replicate, Purpose.RESIDUE_LINES) for replicate in range(tracer.replicates)]
    words = upload(types.UInt32, np.array([stream.generate_state(WORDS, np.uint32) for stream in streams]))

    panes = counters.targets.panes

    def body(number, turn, going, weight, powers, fired):
        replicate = tracer.replicate(number)
        points, choice, side = _numbers(types, words, line, turn, replicate)
        slot = tracer.land_in(tracer.leave(tracer.record(number))(points), replicate, active=going)
        for g, power in enumerate(powers):
            dr.scatter_add(tally, power, slot * n_groups + g, active=going)
        fired = [before + power for before, power in zip(fired, powers, strict=True)]
        here = going & (slot < tracer.total)
        patch = tracer.row(slot)
        rho = dr.gather(types.UInt32, counters.targets.rho, patch, here)
        albedo, across, tau = rho, types.Bool(False), None
        if panes is not None:
            tau = dr.gather(types.UInt32, panes.tau, patch, here)
            albedo = rho + tau
            across = types.UInt64(side) * types.UInt64(albedo) < types.UInt64(tau) << 32
        left = types.UInt32((types.UInt64(weight) * types.UInt64(albedo)) >> 32)
        after = dr.maximum(left, LEAST)
        here &= choice >> 2 < left
        chances = None if tau is None else (across, rho, tau)
        powers = _reflected(counters, powers, patch, here, left, after, chances)
        number = slot if panes is None else dr.select(here & across, panes.beyond(dr.select(here, slot, 0)), slot)
        return number, turn + 1, here, after, powers, fired

    powers = [column(types.Int64, power) for power in begun.power.T]
    none = [dr.zeros(types.Int64, width) for _ in powers]
    state = (number, dr.zeros(types.UInt32, width), going, dr.full(types.UInt32, QUANTUM, width), powers, none)
    _, turn, _, _, _, fired = loop(state, lambda number, turn, going, *rest: going, body)
    with shared(width):
        dr.eval(tally, turn, *fired)
    return [int(frozen(one)[:m].sum()) for one in fired], int(frozen(turn)[:m].sum(dtype=np.int64))


def _reflected(counters: FiringCounters, powers: list, patch, here, left, after, chances=None) -> list:
    """Return the powers of lines that go on with the weight ``after`` where ``left`` is left of it; called in a kernel.

    Args:
        chances: which lines go on from the other side of a diffusing pane, and the reflectance and diffuse transmittance by which
            that was decided; None where nothing diffuses light.
    """
    types, bands = counters.types, counters.bands
    if bands is None:
        return [dr.select(powers[0] < 0, -types.Int64(after), types.Int64(after))]
    wide = types.Float64
    gain = wide(after) / wide(left) * 2.0**-32
    shares = [wide(dr.gather(types.UInt32, rho, patch, here)) * gain for rho in bands.rhos]
    if chances is not None:
        across, rho, tau = chances
        both = wide(rho) + wide(tau)
        shares = [
            dr.select(across, wide(dr.gather(types.UInt32, one, patch, here)) * gain / wide(tau), share / wide(rho)) * both
            for one, share in zip(bands.taus, shares, strict=True)
        ]
        shares = [dr.select(here & (both > 0), share, 0) for share in shares]
    return [types.Int64(dr.round(wide(power) * share)) for power, share in zip(powers, shares, strict=True)]


def _numbers(types, words, line, turn, replicate):
    """Return five numbers of the ``turn``-th line of a walk, a word that decides whether it goes on, and one for the side."""
    first, second = (list(dr.gather(types.Array4u, words, replicate * 2 + half)) for half in (0, 1))
    drawn: Any = philox([line, turn, *first[2:]], first[:2])
    more: Any = philox([line, turn, *second[2:]], second[:2])
    choice, fifth, side, _ = more
    return [types.Float(word >> 8) * 2.0**-24 for word in (*drawn, fifth)], choice, side
