"""Particles, and the step that takes them from one hit to the next.

A walk is (patch, replicate, index): its k-th point of the sequence gives the first segment. Later segments take points of the
same sequence in orders of their own (Latin supercube sampling, see `sampling.numbers.shuffle`), each moved by its own
randomisation, or points of more dimensions (`sampling.numbers.prime_bases`).
So a walk is a function of seed, replicate, patch and index, whatever the order in which walks are followed.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...method import Method
from ...sampling.numbers import AbstractNumbers
from ...sampling.numbers.prime_bases import PrimeBases
from ...sampling.numbers.shuffle import key, mix, shuffled
from ...sampling.streams import Purpose, Seed, stream
from ...tally.far_sides import FarSides
from ...tracing.hits import first_hit, place_of
from ...tracing.line_tracer import LineTracer
from ...tracing.ray_generation import BACK, Frame
from .sorting import Array

SEGMENTS = 64  # number of randomisations; the orders of later segments still differ
INDEX_BITS = 32
GOLDEN = 0x9E3779B9  # (sqrt(5) - 1) / 2 times 2^32


@dataclass(frozen=True)
class ParticleBank:
    """Particles about to leave: columns of Dr.Jit arrays, with one entry for each particle.

    Attributes:
        walk: UInt32, replicate * n_patches + the patch where the walk began.
        index: UInt32, from 1: the number of the walk of that patch.
        place: on a face (face, s, t; see `ray_generation.Frame`) or, with the discrete equation, (patch number,).
        weights: Floats, power carried of each group of bands, in quanta; none where all carry one.
    """

    walk: Any
    index: Any
    place: tuple
    weights: tuple

    @property
    def size(self) -> int:
        return dr.width(self.walk)

    def columns(self) -> tuple:
        return self.walk, self.index, *self.place, *self.weights

    def having(self, columns) -> "ParticleBank":
        """Return the particles with other columns."""
        walk, index, *rest = columns
        n = len(self.place)
        return ParticleBank(walk, index, tuple(rest[:n]), tuple(rest[n:]))

    def at(self, rows) -> "ParticleBank":
        """Return the particles at some indices."""
        chosen = self.having([dr.gather(type(column), column, rows) for column in self.columns()])
        dr.eval(chosen.columns())
        return chosen


@dataclass(frozen=True)
class Step:
    """The result of a segment: the hit's slot of `LineTracer`, the numbers drawn, and the place to go on from."""

    landed: Any
    numbers: Any
    place: tuple


@lru_cache(maxsize=512)  # 1 MiB; a pilot run and the run that follows it have replicates in common
def _drawn(numbers: AbstractNumbers, seed: int, replicate: int, key: tuple[int, ...]) -> np.ndarray:
    """Return the randomisations of later segments, (SEGMENTS, 8) uint32; ``replicate`` is counted from the seed's first one."""
    streams = (stream(seed, replicate, Purpose.LATER_SEGMENTS, segment, *key) for segment in range(SEGMENTS))
    return np.array([numbers.randomisation(of_segment) for of_segment in streams], np.uint32)


class PathSegments:
    """Traces segments of walks in kernels."""

    def __init__(self, tracer: LineTracer, method: Method, panes: FarSides | None = None, block: int = 0):
        self.tracer, self.method, self.panes, key = tracer, method, panes, (block,) if block else ()
        self.continuous, fractional = method.equation == "continuous", method.absorption == "fractional"
        self.one_sequence = fractional and method.padding == "prime-bases"  # the walks of all patches have points of one sequence
        used = (0, 1) if self.continuous else (0, 1, 2, 3)
        used = used if fractional and panes is None else (*used, 4)
        self.primes = PrimeBases.of(tracer.types, used) if method.padding == "prime-bases" else None
        seed = Seed.of(tracer.seed)
        own = [_drawn(tracer.numbers, seed.value, seed.first_replicate + r, key) for r in range(tracer.replicates)]
        self.randomisations = upload(tracer.types.UInt32, np.concatenate(own))

    def in_block(self, block: int) -> "PathSegments":
        """Return the segments of walks whose indices lie in a block; these are of the first one."""
        if block == 0:
            return self
        return PathSegments(self.tracer.of_block(block), self.method, self.panes, block)

    def first(self, number, index, record, bits: int) -> Step:
        """Trace the first segment of a walk, from a uniform point of its patch."""
        tracer = self.tracer
        replicate = tracer.replicate(number)
        numbers = tracer.points(number, index, replicate, record, bits)
        numbers[4:] = self._moved(numbers[4:], number - replicate * tracer.n_opaque)
        return self._land(tracer.leave(record)(numbers), replicate, numbers)

    def later(self, particles: ParticleBank, segment, active: Any = True) -> Step:
        """Trace segment number ``segment`` (UInt32, 1 and up), from where the ``active`` particles are."""
        tracer = self.tracer
        replicate = tracer.replicate(particles.walk)
        patch = particles.walk - replicate * tracer.n_opaque
        randomisation = self._words(replicate, segment)
        if self.primes is None:
            index = shuffled(particles.index, key(randomisation, segment))
            numbers = tracer.numbers.points(index, patch + segment * tracer.n_opaque, randomisation, INDEX_BITS)
        else:
            numbers = self.primes.points(particles.index, segment, randomisation)
        if not self.one_sequence:
            numbers = self._moved(numbers, patch + segment * tracer.n_opaque)
        return self._leave(particles, numbers, replicate, active)

    def in_order(self, particles: ParticleBank, segment, array: Array) -> Step:
        """Trace segment number ``segment`` of sorted particles: the k-th of them takes the k-th point behind those of earlier
        walks."""
        tracer, types = self.tracer, self.tracer.types
        index = array.before + dr.arange(types.UInt32, particles.size) + 1
        stream = segment ^ mix(array.block)
        numbers = tracer.numbers.points(index, stream, self._words(array.replicate, segment), INDEX_BITS)
        return self._leave(particles, self._moved(numbers, stream), array.replicate, True)

    def part(self, segment, array: Array):
        """Return where the cuts lie that tell which sorted particles go on after a segment, UInt32: other cuts in each array."""
        return mix(key(self._words(array.replicate, segment), segment + GOLDEN) + array.before + mix(array.block))

    def _words(self, replicate, segment) -> list:
        """Return the randomisation of a segment of a replicate."""
        row = (replicate * SEGMENTS + (segment & (SEGMENTS - 1))) * 2
        return [word for half in (0, 1) for word in dr.gather(self.tracer.types.Array4u, self.randomisations, row + half)]

    def _leave(self, particles: ParticleBank, numbers: list, replicate, active: Any) -> Step:
        tracer = self.tracer
        if self.continuous:
            face, s, t = particles.place
            line = Frame.of(tracer.geometry, face).leave(s, t, numbers)
        else:
            line = tracer.leave(tracer.record(particles.place[0]))(numbers)
        return self._land(line, replicate, numbers, active)

    def from_side(self, place: tuple, across) -> tuple:
        """Return places from which particles go on, on the other side of diffusing panes where they go ``across``."""
        if across is None or self.panes is None:
            return place
        first, *rest = place
        beyond = first ^ BACK if self.continuous else self.panes.beyond(first, across)
        return dr.select(across, beyond, first), *rest

    def _moved(self, numbers, stream):
        """Return numbers moved modulo 1 by hashes of a stream, the first patch and the segment.

        Without this the k-th walks of all patches would go on and end together, and turn into the same directions: the error was
        measured to be up to 1.8 times as large.
        """
        Float, word, result = self.tracer.types.Float, mix(stream), []
        for number in numbers:
            value = number + Float(word >> 8) * 2.0**-24
            result.append(value - dr.floor(value))
            word = mix(word + GOLDEN)
        return result

    def _land(self, line, replicate, numbers, active: Any = True) -> Step:
        tracer = self.tracer
        hit = first_hit(tracer.geometry, *line, active=active)
        landed = tracer.slot(hit, replicate)
        return Step(landed, numbers, place_of(tracer.geometry, hit) if self.continuous else (landed,))
