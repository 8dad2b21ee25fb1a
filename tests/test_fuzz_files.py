"""A short run of the fuzzer (tests/fuzz/fuzz.py): damaged files of every format, read in a process that is watched."""

import importlib.util
import sys
from pathlib import Path

import pytest

PLACE = Path(__file__).resolve().parent / "fuzz" / "fuzz.py"
SPEC = importlib.util.spec_from_file_location("watched_fuzzing", PLACE)
assert SPEC is not None
assert SPEC.loader is not None
fuzzing = importlib.util.module_from_spec(SPEC)
sys.modules["watched_fuzzing"] = fuzzing
SPEC.loader.exec_module(fuzzing)


FEWER = {"mgf": 10, "npz": 20, "lines": 20, "gltf": 20}  # each takes tens of milliseconds


@pytest.mark.parametrize("many", [False, pytest.param(True, marks=pytest.mark.slow)], ids=["some", "many"])
@pytest.mark.parametrize("name", fuzzing.FORMATS)
def test_damaged_files_of_every_format(name, many):
    if name == "mgf":
        pytest.importorskip("pyradiance")
    count = (20 if name == "mgf" else 100) if many else FEWER.get(name, 40)
    outcome = fuzzing.fuzz(name, 0, count)
    assert outcome.found == {}
    assert sum(outcome.counts.values()) == count
    assert outcome.counts["read"] > 0  # the seeds are sound
    assert outcome.counts["SceneError"] > 0  # and the damage is felt


HARMS = {
    "crash": ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "status -11"),
    "hang": ("import time; time.sleep(60)", "no answer in 1 s"),
    "memory": ("bytearray(1 << 33)", "MemoryError"),
    "warning": ("warnings.warn('overflow', RuntimeWarning)", "RuntimeWarning: overflow"),
}


@pytest.mark.parametrize("harm", HARMS)
def test_harm_is_noticed_and_the_rest_is_read(monkeypatch, tmp_path, harm):
    """A reader that does harm at file 2 of 5."""
    code, told = HARMS[harm]
    worker = (PLACE.parent / "worker.py").read_text()
    start = '            if path.suffix == ".npz":\n'
    assert start in worker
    harmful = f"            if files == damaged('stl-binary', 2):\n                {code}\n{start}"
    (tmp_path / "worker.py").write_text(worker.replace(start, harmful))
    monkeypatch.setenv("PYTHONPATH", f"{PLACE.parent}:{PLACE.parents[1]}:{PLACE.parents[2] / 'src'}")
    monkeypatch.setattr(fuzzing, "HERE", tmp_path)
    monkeypatch.setattr(fuzzing, "SECONDS", 1)
    outcome = fuzzing.fuzz("stl-binary", 0, 5)
    assert list(outcome.found) == [2]
    assert told in outcome.found[2]
    assert sum(outcome.counts.values()) == 5
