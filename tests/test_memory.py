"""Memory: what there is, what a run takes, and that it does not grow with the number of lines."""

import math
from pathlib import Path

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import main
from radiosity.device import memory
from radiosity.lab import footprint
from radiosity.lab.footprint import Footprint, footprints, scene_of
from radiosity.problem.model import Problem
from radiosity.run import memory_estimate
from radiosity.run.budget import Budget

GIB = 2**30
needs_proc = pytest.mark.skipif(not Path("/proc/self/clear_refs").exists(), reason="peaks are measured by Linux's /proc")


@pytest.fixture
def system(tmp_path, monkeypatch):
    """A made-up system: ``system(path, text)`` writes a file of it."""
    monkeypatch.delenv(memory.VARIABLE, raising=False)
    monkeypatch.setattr(memory, "PROC", tmp_path / "proc")
    monkeypatch.setattr(memory, "GROUPS", tmp_path / "groups")
    monkeypatch.setattr(memory, "_process", lambda: math.inf)

    def write(path: str, text: str) -> None:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)

    write("proc/meminfo", "MemTotal:       16777216 kB\nMemAvailable:    8388608 kB\n")
    return write


def test_what_is_free_is_what_the_system_has(system):
    assert memory.free() == 8 * GIB
    assert memory.room() == memory.SHARE * 8 * GIB


def test_nothing_known_is_no_limit(system, monkeypatch):
    system("proc/meminfo", "")
    monkeypatch.setattr(memory.os, "sysconf", lambda name: (_ for _ in ()).throw(ValueError))
    assert memory.free() == math.inf
    memory.refuse(1e30, "a run", "no way out")


def test_control_groups_of_version_2_limit(system):
    system("proc/self/cgroup", "0::/user/job\n")
    system("groups/user/memory.max", f"{3 * GIB}\n")
    system("groups/user/memory.current", f"{2 * GIB}\n")
    system("groups/user/memory.stat", f"anon 5\ninactive_file {GIB}\n")
    system("groups/user/job/memory.max", "max\n")
    system("groups/user/job/memory.current", "7\n")
    assert memory.free() == 2 * GIB  # the group around it has 3, of which files that make room take 1 and the rest 1


def test_where_a_group_is_slowed_down_it_is_limited(system):
    """Above memory.high nothing is killed: the run would seem to hang."""
    system("proc/self/cgroup", "0::/job\n")
    system("groups/job/memory.max", f"{6 * GIB}\n")
    system("groups/job/memory.current", f"{GIB}\n")
    system("groups/job/memory.high", "max\n")
    assert memory.free() == 5 * GIB
    system("groups/job/memory.high", f"{4 * GIB}\n")
    assert memory.free() == 3 * GIB


def test_control_groups_of_version_1_limit(system):
    system("proc/self/cgroup", "9:name=systemd:/\n4:cpu,memory:/a/b\n0::/\n")
    system("groups/memory/memory.limit_in_bytes", "9223372036854771712\n")
    system("groups/memory/memory.usage_in_bytes", "1000\n")
    assert memory.free() == 8 * GIB
    system("groups/memory/a/memory.limit_in_bytes", f"{2 * GIB}\n")
    system("groups/memory/a/memory.usage_in_bytes", f"{GIB}\n")
    assert memory.free() == GIB


def test_the_process_may_be_limited(system, monkeypatch):
    resource = pytest.importorskip("resource")
    monkeypatch.undo()
    monkeypatch.setattr(resource, "getrlimit", lambda which: (10**15, 10**15))
    left = memory._process()
    assert 10**15 - 10**12 < left < 10**15
    monkeypatch.setattr(resource, "getrlimit", lambda which: (1000, 1000))
    assert memory.free() == 0


def test_what_the_process_has_is_counted_in_kibibytes(tmp_path, monkeypatch):
    resource = pytest.importorskip("resource")
    monkeypatch.setattr(memory, "PROC", tmp_path)
    (tmp_path / "self").mkdir()
    (tmp_path / "self" / "status").write_text("Name:\tpython\nVmPeak:\t 9000000 kB\nVmSize:\t 2097152 kB\n")
    monkeypatch.setattr(resource, "getrlimit", lambda which: (5 * GIB, resource.RLIM_INFINITY))
    assert memory._process() == 3 * GIB
    monkeypatch.setattr(resource, "getrlimit", lambda which: (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    assert memory._process() == math.inf


@pytest.mark.parametrize(
    ("text", "bytes_"), [("8G", 8 * GIB), ("500 MiB", 500 * 2**20), ("1.5k", 1536), ("7", 7), ("none", math.inf)]
)
def test_the_environment_may_say_how_much(monkeypatch, text, bytes_):
    monkeypatch.setenv(memory.VARIABLE, text)
    assert memory.room() == bytes_


@pytest.mark.parametrize("text", ["lots", "-1G", "8GG", "1e3"])
def test_a_senseless_limit_is_refused(monkeypatch, text):
    monkeypatch.setenv(memory.VARIABLE, text)
    with pytest.raises(rd.MethodError, match="RADIOSITY_MEMORY is"):
        rd.solve(rd.load_scene("room"), "random-walk", quanta=10)


@pytest.mark.parametrize(("size", "bytes_"), [("8G", 8 * GIB), (1000, 1000), (1e17, 1e17), ("none", math.inf)])
def test_a_run_may_be_told_how_much(monkeypatch, size, bytes_):
    monkeypatch.setenv(memory.VARIABLE, "7")
    with memory.limited(size):
        assert memory.room() == bytes_
        with memory.limited(None):
            assert memory.room() == bytes_
    assert memory.room() == 7


@pytest.mark.parametrize("method", ["random-walk", "full-matrix"])
def test_a_run_that_was_told_keeps_to_it(capsys, method):
    with pytest.raises(rd.MethodError, match=r"1 MiB are allowed \(memory\); take larger patches"):
        rd.solve(rd.load_scene("room"), method, memory="1M", **({"rays": 10**6} if method == "random-walk" else {}))
    with pytest.raises(rd.MethodError, match="memory is 'lots'"):
        rd.solve(rd.load_scene("room"), method, memory="lots", **({"rays": 10**6} if method == "random-walk" else {}))
    assert main(["solve", "room", "--method", method, "--memory", "1M"]) == 2
    assert "1 MiB are allowed (memory)" in capsys.readouterr().err


@needs_proc
def test_what_an_earlier_run_freed_does_not_hide_what_the_next_one_takes():
    def take():
        return [np.ones(8_000) for _ in range(2_000)]  # 128 MB in small pieces, which the C library keeps when they are freed

    kept = [take(), np.ones(8_000)][1]  # what is at the end of the heap holds it
    before = footprint.resident()
    taken = take()
    assert footprint.peak() - before > 0.9 * 8 * 8_000 * len(taken)
    assert len(kept) == 8_000


@pytest.mark.parametrize("method", [rd.Method(), rd.Method(equation="continuous"), rd.Method(order="regular")], ids=str)
def test_expected_memory_grows_with_bands_replicates_and_patches(method):
    """By the table: each group of bands and each replicate takes its own."""
    few, many = (rd.subdivide(rd.load_scene("room"), cells=cells) for cells in (2, 20))
    one = memory_estimate.MEMORY_ESTIMATES[method.machine]

    def wanted(patches, groups, replicates):
        return memory_estimate.memory_needed(method, patches, groups, replicates, None)

    for patches in (few, many):
        n = len(patches)
        assert wanted(patches, 3, 8) - wanted(patches, 1, 8) == pytest.approx(2 * 8 * n * one.group)
        assert wanted(patches, 3, 8) - wanted(patches, 3, 1) == pytest.approx(7 * n * (one.replicate + 3 * one.group))
    more = len(many) - len(few)
    expected = more * (one.patch + one.band + 2 * (one.replicate + one.group))
    assert wanted(many, 1, 2) - wanted(few, 1, 2) == pytest.approx(expected)


def test_counted_lines_take_memory_by_their_number_however_it_is_given():
    """Of lines of the patches that is known; each patch has 4 in each replicate at least. Of global ones it is known for rays."""
    patches, matrix = rd.subdivide(rd.load_scene("room"), cells=20), rd.Method(order="matrix")
    n, pair = len(patches), memory_estimate.PAIR
    few, more, most = (memory_estimate.memory_needed(matrix, patches, 1, 8, rays) for rays in (1, 10**6, None))
    assert more - few == pytest.approx(pair * (10**6 - 4 * 8 * n))
    assert most - few == pytest.approx(pair * (memory_estimate.LIMIT - 4 * 8 * n))
    assert memory_estimate.lines_of(matrix, Budget(quanta=1000), 8) == 8000
    assert memory_estimate.lines_of(matrix, Budget(rays=500), 8) == 500
    assert memory_estimate.lines_of(rd.Method(order="matrix", lines="spans"), Budget(quanta=1000), 8) is None
    assert memory_estimate.lines_of(matrix, Budget(seconds=1), 8) is None


def test_what_will_not_fit_is_refused_before_it_begins(monkeypatch):
    patches = rd.subdivide(rd.load_scene("cornell-box"), about=200_000)
    monkeypatch.setenv(memory.VARIABLE, "200M")
    with pytest.raises(rd.MethodError, match=r"about \S+ [GM]iB of memory, and 200 MiB are allowed .*; take larger patches$"):
        rd.solve(patches, "transillumination", rays=1_000_000)
    few = "take [1-9][0-9]? replicates or fewer, or larger patches"
    with pytest.raises(rd.MethodError, match=few):
        rd.solve(patches, "random-walk", rays=1_000_000, replicates=64)
    monkeypatch.setattr("radiosity.run.solve.tell", lambda scene: pytest.fail("faces are searched first, which takes minutes"))
    with pytest.raises(rd.MethodError, match=few):
        rd.solve(patches, "random-walk", rays=1_000_000, replicates=64)
    monkeypatch.delenv(memory.VARIABLE)
    monkeypatch.setattr(memory, "free", lambda: 200e6)
    with pytest.raises(rd.MethodError, match=r"191 MiB are free; .*--memory 16G or none"):
        rd.solve(patches, "random-walk", rays=1_000_000, replicates=64)


def measured(*task, warm: bool) -> list[Footprint]:
    found = footprints(*task, warm=warm)
    assert not isinstance(found, str), found
    return found


def test_planes_count():
    """Few hits make wide kernels: squares of the number of patches."""

    def expected(about, rays):
        patches = rd.subdivide(scene, about=about)
        return memory_estimate.memory_needed(rd.method.resolve("density-estimation"), patches, 1, 8, rays)

    scene = rd.load_scene("room")
    assert expected(80_000, 100) > 8 * expected(20_000, 100) > 0
    assert expected(80_000, 100) > 2 * expected(80_000, 1e6)


LINES = 1_500_000  # launches are full from about 10^6 lines on
SLOW_METHODS = [pytest.param(name, marks=pytest.mark.slow) for name in ("stochastic-jacobi", "density-estimation")]


@needs_proc
@pytest.mark.parametrize("method", ["random-walk", *SLOW_METHODS])
def test_expected_memory_is_within_a_factor_of_two(method):
    """All methods: benchmarks/memory_estimate.py."""
    about = 30_000 if method == "density-estimation" else 100_000
    patches = rd.subdivide(scene_of("cornell-box"), about=about, powers_of_two=True)
    (taken,) = measured("cornell-box", about, method, [("run", {"rays": LINES})], warm=False)
    chosen = rd.method.resolve(method)
    assert isinstance(chosen, rd.Method)
    expected = memory_estimate.memory_needed(chosen, patches, Problem.of(patches).groups.n_groups, 8, LINES)
    assert 0.5 < expected / taken.memory < 2


@needs_proc
def test_memory_does_not_grow_with_the_number_of_lines():
    """Launches are full from about 10^6 lines on, and take what is fixed; four bytes a line would be more than twice as much."""
    few, many = measured("room", 5_000, "random-walk", [("1M", {"rays": 10**6}), ("30M", {"rays": 3 * 10**7})], warm=True)
    assert many.lines > 25 * few.lines
    assert many.memory - few.memory < memory_estimate.MEMORY_ESTIMATES["firing"].fixed


@pytest.mark.parametrize("method", [pytest.param("gather", marks=pytest.mark.slow), "random-walk"])
def test_large_images_of_a_sky_count(method):
    """1.6 million entries took 165 bytes each at the peak; lines through openings have tables of their own."""
    floor = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.5, 0.0, photometric=True)
    patches = rd.subdivide(floor.with_lights(sky=rd.uniform_sky(1.0)), cells=1)
    sky = rd.Sky("image", np.ones((512, 1024, 3)) * [1.0, 2.0, 3.0], np.eye(3))
    image, window = rd.subdivide(floor.with_lights(sky=sky), cells=1), [[0, 0, 1], [1, 0, 1], [0, 1, 1]]
    opened = rd.subdivide(floor.with_lights(sky=sky, openings=[window]), cells=1)
    few, many, more = (memory_estimate.memory_needed(rd.PRESETS[method].method, p, 1, 1, 1e4) for p in (patches, image, opened))
    assert many - few == pytest.approx(165 * 512 * 1024 * 3, rel=0.01)
    assert more - many == pytest.approx(2 * 90 * 512 * 1024 * 3 if method == "random-walk" else 0, rel=0.01)
    with pytest.raises(rd.MethodError, match="would take about"):
        rd.solve(image, method, rays=1e4, memory="200M")
    assert rd.solve(patches, method, rays=1e4, memory="200M").status == "complete"
