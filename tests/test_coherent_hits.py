"""Coherent packets: where several faces lie in one plane, what a line meets is a function of the line, not of its packet."""

import numpy as np
import pytest
from test_coplanar import VARIANTS, two_rooms

import radiosity as rd
from radiosity.device.backend import choose, upload
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.line_tracer import LineTracer

LINES = 1 << 17


def slots(tracer: LineTracer, number: np.ndarray, index: np.ndarray, coherent: bool) -> np.ndarray:
    """The slot in which each line ends, traced in the order of the arrays."""
    types = tracer.types
    numbers = upload(types.UInt32, number)
    record = tracer.record(numbers)
    replicate = types.UInt32(0)
    line = tracer.leave(record)(tracer.points(numbers, upload(types.UInt32, index), replicate, record, 32))
    return tracer.land_in(line, replicate, coherent).numpy()[: len(number)]


@pytest.mark.parametrize("name", ["plain", "cut otherwise", "turned", "turned and far"])
def test_packets_choose_no_face_of_a_plane(name, random):
    patches = rd.subdivide(two_rooms(**VARIANTS[name]), cells=1)
    geometry = Geometry(patches, choose("cpu"))
    tracer = LineTracer.of(geometry, "halton", "by-patch", 0, 1)
    number = np.arange(LINES, dtype=np.uint32) * len(patches) // LINES
    index = np.arange(LINES, dtype=np.uint32) % (LINES // len(patches)) + 1
    alone = slots(tracer, number, index, False)
    assert geometry.ties is not None
    assert np.array_equal(slots(tracer, number, index, True), alone)
    order = random.permutation(LINES)
    assert np.array_equal(slots(tracer, number[order], index[order], True), alone[order])
