"""What the tests share: scenes made by strangers, where a checkout has them, and a small closed box."""

import gc
import os
import signal
import sys
from functools import partial, wraps
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings

import radiosity as rd

settings.register_profile("repeatable", deadline=None, derandomize=True, database=None)
settings.load_profile("repeatable")

gc.set_threshold(100_000, 50)  # syntax trees are a million objects, which the collector would look through again and again

STRANGERS = Path(__file__).resolve().parents[2] / "shared" / "scenes"


@pytest.fixture(scope="session")
def strangers() -> Path:
    """Folder of scenes made by others; tests that need it are skipped where it is absent."""
    if not STRANGERS.is_dir():
        pytest.skip("the scenes made by strangers are not beside this checkout (../shared/scenes)")
    return STRANGERS


@pytest.fixture(scope="session")
def strangers_or_none() -> Path | None:
    """The same, for tests that have more than these: None where it is absent."""
    return STRANGERS if STRANGERS.is_dir() else None


@pytest.fixture(scope="session", autouse=True)
def ctrl_c_is_heard():
    """As in a program of its own: test processes of pytest-xdist do not hear it, nor do the programs that they start."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session", autouse=True)
def one_thread_in_each_test_process():
    """Where pytest-xdist runs several: threads that wait for each other's cores take a third of the time. Tests of threads set
    their number themselves, and results do not depend on it. What reads EXR files by Mitsuba needs `device.bitmaps`."""
    if "PYTEST_XDIST_WORKER" in os.environ:
        from radiosity.device.backend import choose

        choose("cpu")  # before drjit is imported
        import drjit as dr

        dr.set_thread_count(1)


@pytest.fixture(scope="module", autouse=True)
def our_variant_comes_back():
    """After each file: where Mitsuba stayed in another variant, each BVH of later tests would change it twice, in 0.1 s."""
    yield
    if "mitsuba" in sys.modules:
        import mitsuba as mi

        from radiosity.device.backend import choose

        if mi.variant() not in (None, choose("cpu").variant):
            mi.set_variant(choose("cpu").variant)


@pytest.fixture(scope="session", autouse=True)
def nothing_is_evaluated_in_recorded_loops():
    """In all tests: what kernels are made of calls nothing of Dr.Jit that evaluates arrays while a loop is recorded."""
    import drjit as dr

    from radiosity.device.recorded import not_recorded

    flag, recorded = dr.flag, dr.JitFlag.SymbolicScope  # some tests call these functions a thousand times

    def guarded(name):
        function = getattr(dr, name)

        @wraps(function)
        def call(*arguments, **options):
            if flag(recorded):
                not_recorded(f"dr.{name} is called")
            return function(*arguments, **options)

        return call

    with pytest.MonkeyPatch.context() as patch:
        for name in ("eval", "opaque", "make_opaque", "schedule", "compress", "prefix_sum", "sync_thread"):
            patch.setattr(dr, name, guarded(name))
        yield


@pytest.fixture(scope="session", autouse=True)
def warnings_after_a_run_are_errors_too():
    """In all tests: a warning that would only be told, so that no result is lost, raises like others that no test expects."""

    def raised(text: str) -> None:
        raise rd.RadiosityWarning(text)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("radiosity.errors.tell_instead", raised)
        yield


@pytest.fixture
def random() -> np.random.Generator:
    return np.random.Generator(np.random.Philox(7))


@pytest.fixture
def cube() -> rd.Scene:
    """A closed unit cube seen from inside, reflectance 1/2, emission 1 on all six sides."""
    from radiosity.scene.shapes import box, join

    names = ("south", "north", "west", "east", "floor", "ceiling")
    faces = box((0, 0, 0), (1, 1, 1), inward=True)
    return join([(name, 0.5, 1.0, [face]) for name, face in zip(names, faces, strict=True)], source="cube")


@pytest.fixture
def small_pictures(monkeypatch):
    """Pictures among the outputs of a run are 80 pixels wide: large ones take seconds each."""
    from radiosity.image import still

    monkeypatch.setattr(still, "render", partial(still.render, width=80))


@pytest.fixture(scope="session")
def geometry_of():
    """Patches on the device that there is."""
    from radiosity.device.backend import choose
    from radiosity.tracing.geometry import Geometry

    return lambda patches: Geometry(patches, choose())


@pytest.fixture(scope="module")
def client():
    """Two workers of Dask that are threads of this process."""
    distributed = pytest.importorskip("distributed", reason="distributed is not installed")
    options = {"n_workers": 2, "threads_per_worker": 1, "processes": False, "dashboard_address": "127.0.0.1:0"}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster) as client:
        yield client
