"""Workers on one machine take one GPU each: what environment they get, and what is told. None of it needs a GPU."""

import os
import socket

import pytest

import radiosity as rd

pytest.importorskip("distributed", reason="distributed is not installed")
from radiosity.cluster import gpus
from radiosity.cluster.connect import connected

HERE = socket.gethostname()


class Workers:
    """A client whose workers have said what they see."""

    def __init__(self, *seen):
        self.seen = dict(enumerate(seen))

    def run(self, asked, on_error):
        assert (asked, on_error) == (gpus.first_seen, "ignore")
        return {f"tcp://{HERE}:{port}": (host, name) for port, (host, name) in self.seen.items()}


@pytest.mark.parametrize(
    ("given", "count", "wanted"),
    [(None, 3, ["0", "1", "2"]), ("2, 3", 2, ["2", "3"]), ("GPU-a,GPU-b", 2, ["GPU-a", "GPU-b"]), ("1,-1,0", 1, ["1"])]
    + [(given, 0, []) for given in (None, "", "5")],
)
def test_gpus_that_a_process_may_use(given, count, wanted, monkeypatch):
    monkeypatch.setattr(gpus, "_count", lambda: count)
    monkeypatch.delenv(gpus.NAMES, raising=False)
    if given is not None:
        monkeypatch.setenv(gpus.NAMES, given)
    assert gpus.visible() == wanted
    assert gpus.environments(3) == [{gpus.NAMES: wanted[n % len(wanted)]} if wanted else {} for n in range(3)]


def test_the_driver_of_cuda_is_asked_without_an_error():
    """Here there may be none; the library of CUDA, where there is one, says a number."""
    assert gpus._count() >= 0


def test_processes_see_one_gpu_each(monkeypatch):
    monkeypatch.setattr(gpus, "visible", lambda: ["3", "GPU-b"])
    before = os.environ.get(gpus.NAMES)
    with connected("local:2") as client:
        assert sorted(client.run(gpus.first_seen).values()) == [(HERE, "3"), (HERE, "GPU-b")]
        monkeypatch.setattr(gpus, "visible", lambda: ["3", "GPU-b", "5"])
        with pytest.warns(rd.RadiosityWarning, match="no worker traces on the GPUs 5 of this machine"):
            gpus.tell_of_shared(client, "cuda")
    assert os.environ.get(gpus.NAMES) == before


def test_workers_on_one_gpu_are_told(monkeypatch, recwarn):
    monkeypatch.setattr(gpus, "visible", list)
    gpus.tell_of_shared(Workers((HERE, "0"), (HERE, "0")), "cpu")
    gpus.tell_of_shared(Workers((HERE, "0"), (HERE, "1"), ("other", "0"), ("third", "0")), "cuda")
    assert not recwarn.list
    words = r"2 workers on other trace on one GPU \(0\).*:1, .*:2\. Start one worker"
    with pytest.warns(rd.RadiosityWarning, match=words) as told:
        gpus.tell_of_shared(Workers((HERE, "0"), ("other", "0"), ("other", "0")), "cuda")
    assert len(told) == 1
