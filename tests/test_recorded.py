"""Nothing is made on the device while Dr.Jit records a loop: there it ends the process at some lengths (`device.recorded`)."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.device.backend import choose, frozen, upload
from radiosity.device.recorded import RecordedError, loop
from radiosity.sampling.numbers import NUMBERS, binary, make, quinary, ready, scrambled_halton
from radiosity.sampling.streams import Purpose, stream
from radiosity.scene.model import Back
from radiosity.scene.shapes import box
from radiosity.tracing.geometry import Geometry
from radiosity.tracing.global_lines.crossing import Crossings
from radiosity.tracing.global_lines.spans import Spans
from radiosity.tracing.hits import first_hit

LANES = 8


@pytest.fixture
def cold():
    """As in a fresh process: no sequence has its tables on the device yet."""
    for tables in (binary._tables, quinary._table, scrambled_halton._table):
        tables.cache_clear()


def in_a_loop(types, what):
    """Values that ``what(count)`` gives in a recorded loop of one turn."""
    import drjit as dr

    zero = dr.arange(types.UInt32, LANES) * dr.opaque(types.UInt32, 0)

    def body(turn, value):
        return turn + 1, types.Float(what(turn))

    _, value = loop((zero, types.Float(zero)), lambda turn, value: turn < 1, body)
    return np.array(value)


@pytest.mark.parametrize("length", [1, 2, LANES, 100])
def test_an_upload_within_a_loop_is_an_error_at_any_length(length):
    types = choose().types
    values = np.arange(length, dtype=np.uint32)
    with pytest.raises(RecordedError, match="before the loop"):
        in_a_loop(types, lambda turn: upload(types.UInt32, values))
    assert np.array_equal(np.array(upload(types.UInt32, values)), values)  # and what comes after it is as ever
    assert np.array_equal(in_a_loop(types, lambda turn: turn + 3), np.full(LANES, 3.0))


def test_reading_an_array_within_a_loop_is_an_error():
    import drjit as dr

    types = choose().types
    ready = dr.opaque(types.UInt32, 1, LANES)
    with pytest.raises(RecordedError, match="read"):
        in_a_loop(types, lambda turn: frozen(ready)[0])


@pytest.mark.parametrize("name", ["opaque", "eval"])
def test_tests_watch_over_what_evaluates(name):
    """The guard of `conftest`."""
    import drjit as dr

    types = choose().types
    made = {"opaque": lambda turn: dr.opaque(types.UInt32, 1, LANES), "eval": lambda turn: dr.eval(turn)}
    with pytest.raises(RecordedError, match=name):
        in_a_loop(types, made[name])


@pytest.mark.parametrize("name", NUMBERS)
def test_points_of_numbers_that_are_ready_can_be_asked_for_in_a_loop(cold, name):
    import drjit as dr

    types = choose().types
    words = [types.UInt32(int(word)) for word in make(name).randomisation(stream(2, 0, Purpose.NUMBERS))]
    numbers = ready(name, types)
    for bits in numbers.steps():
        found = in_a_loop(types, lambda turn, bits=bits: numbers.points(turn + 9, turn, words, bits)[3])
        nine = dr.opaque(types.UInt32, 9, LANES)
        assert np.array_equal(found, np.array(numbers.points(nine, types.UInt32(0), words, bits)[3]))


@pytest.mark.parametrize("name", ["sobol", "niederreiter", "faure", "generalized-faure", "scrambled-halton"])
def test_tables_of_numbers_that_are_not_ready_are_missed_in_a_loop(cold, name):
    types = choose().types
    words = [types.UInt32(int(word)) for word in make(name).randomisation(stream(2, 0, Purpose.NUMBERS))]
    with pytest.raises(RecordedError):
        in_a_loop(types, lambda turn: make(name).points(turn + 9, turn, words, 32)[3])


@pytest.fixture
def passing():
    """A unit cube of six faces, seen from inside; their backs let lines pass."""
    faces = box((0, 0, 0), (1, 1, 1), inward=True)
    corners = np.array(faces).reshape(-1, 3)
    index = np.arange(24).reshape(-1, 4)
    emission = np.array([1.0, 0, 0, 0, 0, 0])
    return rd.Scene.from_arrays(corners, index, np.full(6, 0.5), emission, back=np.full(6, int(Back.PASSES)))


def test_lines_that_pass_backs_find_their_records_made(passing):
    """`first_hit` in no loop makes what its own loop reads: geometry that nobody prepared."""
    geometry = Geometry(rd.subdivide(passing, cells=1), choose())
    types, tree = geometry.device.types, geometry.bvh
    start = (np.array([[0.5, 0.5, -1.0]] * LANES) - tree.centre) * tree.scale
    origin = types.Array3f(*(upload(types.Float, column.astype(np.float32)) for column in start.T))
    hit = first_hit(geometry, origin, types.Array3f(0.0, 0.0, 1.0))
    assert np.allclose(np.array(hit.distance) / tree.scale, 2.0)  # through the floor's back to the ceiling
    assert np.array(hit.front).all()


def test_rays_for_pictures_and_checks_find_their_records_made(passing):
    from radiosity.tracing.first_hits import first_hits

    hits = first_hits(passing, np.array([[0.5, 0.5, -1.0]]), np.array([[0.0, 0.0, 1.0]]))
    assert hits.front[0]
    assert np.isclose(hits.distance[0], 2.0)


@pytest.mark.parametrize("lines", ["spans", "global", "global-disc", "bundles"])
def test_spans_find_their_records_made(passing, lines):
    """In a scene that nobody traced a line in: the loops of `chords` and, where backs pass, of `surfaces`."""
    geometry = Geometry(rd.subdivide(passing, cells=1), choose())
    method = rd.Method(lines=lines, order="matrix")
    pairs = Spans(geometry, method, seed=1, replicates=1).draw(0, 0, 64)
    assert len(pairs.one) > 0
    assert not np.array_equal(pairs.one, pairs.other)


def test_crossings_are_made_before_a_loop_reads_them(passing):
    crossings = Crossings(Geometry(rd.subdivide(passing, cells=1), choose()))
    crossings.prepare()
    types, tree = crossings.geometry.device.types, crossings.geometry.bvh
    low = types.Array3f(*(float(x) for x in (np.array([0.5, 0.5, -1.0]) - tree.centre) * tree.scale))
    up = types.Array3f(0.0, 0.0, 1.0)
    assert in_a_loop(types, lambda turn: crossings.next(low, up, turn < 1).valid & True).all()
