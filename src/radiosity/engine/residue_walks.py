"""The lines that send the residue on, and the walks they begin (see `residue`): outside the counters of hits and lines fired."""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from ..method.numbers import WORDS
from ..method.numbers.random import philox
from . import quanta as contract
from .bands import QUANTUM
from .blocks import shared
from .device import frozen, upload
from .lines import local_line
from .process import State
from .residue import Groups, Starts


@dataclass(frozen=True, eq=False)
class Sent:
    """What residues brought, signed: in quanta, or in units of bands where these differ (see `BandTally`).

    Attributes:
        landed: (replicates, n_patches, n_groups) int32 or int64.
        missed: (2, replicates, n_groups), escaped and lost.
        fired: n_groups whole numbers, what left patches along lines, of all replicates.
        lines: of all replicates.
    """

    landed: np.ndarray
    missed: np.ndarray
    fired: list[int]
    lines: int


def starts(engine, state: State) -> Starts:
    """Where lines begin after the state's stage."""
    phase = frozen(engine.phase).reshape(engine.replicates, engine.n)
    quanta = int(state["quanta"])
    groups = Groups.of(engine.geometry.patches, quanta)
    return Starts.of(engine.source, groups, quanta, state["arrivals"], phase, engine.seed)


def send(engine, state: State) -> Sent:
    """Send the residues of a complete stage on.

    Args:
        engine: of the run; its counters are left alone.
        state: of the stage.
    """
    types, n_groups = engine.types, 1 if engine.bands is None else engine.bands.n
    tally = dr.zeros(types.Int if engine.bands is None else types.Int64, (engine.total + 2 * engine.replicates) * n_groups)
    dr.eval(tally)
    begun = starts(engine, state)
    fired, lines = [0] * n_groups, 0
    if len(begun.sign):
        fired, lines = _walk(engine, begun, _carried(engine, state, begun), tally)
    flat = frozen(tally).reshape(-1, n_groups)
    landed = flat[: engine.total].reshape(engine.replicates, engine.n, n_groups)
    return Sent(landed, flat[engine.total :].reshape(2, engine.replicates, n_groups), fired, lines)


def _carried(engine, state: State, begun: Starts) -> list[np.ndarray]:
    """(m,) int64 of each group: what lines carry at first. Of bands what each has of a patch's power, over that of the scalar
    problem: as it is of each line that the patch has fired, where it is the same in all sweeps."""
    if engine.bands is None:
        return [begun.sign]
    patch, quanta = begun.patch, int(state["quanta"])
    emission, reflectance = engine.bands.groups.emission, engine.bands.groups.reflectance
    unit = engine.geometry.patches.area[patch] / engine.source.power * quanta
    owed = engine.source.share[patch] * quanta + engine.source.rho[patch] * 2.0**-32 * state["arrivals"][begun.replicate, patch]
    carried = []
    for g in range(engine.bands.n):
        power = emission[patch, g] * unit * QUANTUM + reflectance[patch, g] * state["received"][begun.replicate, patch, g]
        carried.append(begun.sign * np.round(np.minimum(power / owed, QUANTUM)).astype(np.int64))
    return carried


def _walk(engine, begun: Starts, carried: list[np.ndarray], tally) -> tuple[list[int], int]:
    """One lane a line, which a walk follows to its end: it goes on with the probability of the scalar problem's reflectance. One
    kernel for all, with as many replicates as there may be."""
    types, bands, m = engine.types, engine.bands, len(begun.sign)
    n_groups, width = len(carried), max(m, 2)  # arrays of one entry would compile a kernel of their own

    def column(kind, values):
        return upload(kind, np.resize(values, width))

    number = column(types.UInt32, (begun.replicate * engine.n + begun.patch).astype(np.uint32))
    line = column(types.UInt32, begun.line)
    weights = [column(type(tally), weight) for weight in carried]
    streams = [contract.stream(engine.seed, replicate, contract.RESIDUE_LINES) for replicate in range(engine.replicates)]
    words = upload(types.UInt32, np.array([stream.generate_state(WORDS, np.uint32) for stream in streams]))

    def body(number, turn, going, weights, spent):
        replicate = engine.replicate(number)
        points, choice = _numbers(types, words, line, turn, replicate)
        slot = engine.land_in(local_line(engine.geometry, engine.record(number), points), replicate, going)
        for g, weight in enumerate(weights):
            dr.scatter_add(tally, weight, slot * n_groups + g, active=going)
        spent = [one + weight for one, weight in zip(spent, weights, strict=True)]
        here = going & (slot < engine.total)
        patch = slot - engine.replicate(slot) * engine.n_opaque
        rho = dr.gather(types.UInt32, engine.rho, patch, here)
        here &= choice < rho
        if bands is not None:
            shares = [dr.gather(types.UInt32, one, patch, here) for one in bands.rhos]
            wide = types.Float64
            weights = [types.Int64(dr.round(wide(w) * (wide(s) / wide(rho)))) for w, s in zip(weights, shares, strict=True)]
        return slot, turn + 1, here, weights, spent

    going = dr.arange(types.UInt32, width) < dr.opaque(types.UInt32, m)
    state = (number, dr.zeros(types.UInt32, width), going, weights, [dr.zeros(type(weight), width) for weight in weights])
    _, turn, _, _, spent = dr.while_loop(state, lambda number, turn, going, weights, spent: going, body, mode="symbolic")
    with shared(width):
        dr.eval(tally, turn, *spent)
    return [int(frozen(one)[:m].sum(dtype=np.int64)) for one in spent], int(frozen(turn)[:m].sum(dtype=np.int64))


def _numbers(types, words, line, turn, replicate):
    """In a kernel: four numbers of the ``turn``-th line of a walk, and a word that decides whether it goes on."""
    first, second = (dr.gather(types.Array4u, words, replicate * 2 + half) for half in (0, 1))
    key, more = list(first), list(second)
    points = [types.Float(word >> 8) * 2.0**-24 for word in philox([line, turn, *key[2:]], key[:2])]
    return points, philox([line, turn, *more[2:]], more[:2])[0]
