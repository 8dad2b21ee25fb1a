"""Clusters of real processes: workers and schedulers that are killed, and TLS. Each test takes some ten seconds."""

import os
import re
import shutil
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from test_merge import assert_same

import radiosity as rd

pytest.importorskip("distributed", reason="distributed is not installed")
pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system"),
]
SOLVE = ("room", "--cells", "3", "--method", "random-walk", "--quanta", "4M", "--replicates", "4", "--seed", "5")
LIMIT = 240  # seconds


class Processes:
    """A scheduler and its workers."""

    def __init__(self, workers: int, *options: str, env: dict[str, str] | None = None):
        self.options, self.env, self.workers = options, {**os.environ, **(env or {})}, []
        self.scheduler = self._start("dask_scheduler", "--host", "127.0.0.1", "--port", "0", stderr=subprocess.PIPE)
        lines = iter(self.scheduler.stderr)
        self.address = next(found.group(1) for line in lines if (found := re.search(r"Scheduler at:\s+(\S+)", line)))
        threading.Thread(target=lambda: [None for _ in lines], daemon=True).start()
        for _ in range(workers):
            self.add()

    def add(self) -> None:
        self.workers.append(self._start("dask_worker", self.address, "--no-nanny", "--nthreads", "1", stderr=subprocess.DEVNULL))

    def _start(self, program: str, *arguments: str, stderr: int) -> subprocess.Popen:
        command = [sys.executable, "-m", f"distributed.cli.{program}", *arguments, *self.options, "--no-dashboard"]
        return subprocess.Popen(command, stderr=stderr, stdout=subprocess.DEVNULL, text=True, env=self.env)

    def __enter__(self) -> "Processes":
        return self

    def __exit__(self, *_) -> None:
        for process in [*self.workers, self.scheduler]:
            process.kill()
            process.wait()
        self.scheduler.stderr.close()


def alone() -> rd.Solution:
    return rd.solve(rd.subdivide(rd.load_scene("room"), cells=3), "random-walk", quanta=4 * 10**6, replicates=4, seed=5)


def program(*arguments: str, **options) -> subprocess.Popen:
    command = [sys.executable, "-m", "radiosity", "solve", *arguments]
    return subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, **options)


def on_first_lines(act) -> tuple[object, list]:
    """Return a listener that acts once some lines have come back, and a list that then is not empty."""
    done = []

    def listen(moment):
        if moment.stage > 0 and moment.rays > 1e6 and not done:
            done.append(moment.rays)
            act()

    return listen, done


def solved(processes: Processes, act, path: Path) -> rd.Solution:
    listen, done = on_first_lines(act)
    patches = rd.subdivide(rd.load_scene("room"), cells=3)
    options = {"quanta": 4 * 10**6, "replicates": 4, "seed": 5, "cluster": processes.address}
    found = rd.solve(patches, "random-walk", **options, progress=listen, checkpoint=path, checkpoint_every=1)
    assert done
    return found


def test_killed_workers_lose_nothing(tmp_path):
    with Processes(2) as processes:

        def kill():
            processes.workers[0].kill()
            processes.add()

        assert_same(solved(processes, kill, tmp_path / "run.npz"), alone())


@pytest.mark.parametrize("method", ["random-walk", "particle-tracing", "gather", "stochastic-jacobi"])
def test_a_worker_killed_while_two_work_at_one_replicate(method):
    patches, options = rd.subdivide(rd.load_scene("room"), cells=3), {"quanta": 3 * 10**6, "replicates": 1, "seed": 5}
    with Processes(2) as processes:

        def kill():
            processes.workers[0].kill()
            processes.add()

        later = threading.Timer(0.3, kill)
        listen, done = on_first_lines(later.start)  # while they trace
        found = rd.solve(patches, method, **options, cluster=processes.address, progress=listen)
        assert done
        later.join()  # a worker that it adds ends with the others, also where the run was quicker
    assert_same(found, rd.solve(patches, method, **options))


def test_all_workers_killed(tmp_path):
    with Processes(2) as processes:

        def kill():
            for worker in processes.workers:
                worker.kill()
            processes.add()

        assert_same(solved(processes, kill, tmp_path / "run.npz"), alone())


def test_a_lost_scheduler_leaves_a_checkpoint_that_goes_on(tmp_path):
    kept, out = tmp_path / "run.checkpoint.npz", tmp_path / "run.npz"
    with Processes(2) as processes, pytest.warns(rd.RadiosityWarning, match="does not answer"):
        lost = solved(processes, processes.scheduler.kill, kept)
    assert lost.status == "interrupted"
    with program(*SOLVE, "--resume", str(kept), "--cluster", "local:2", "-o", str(out)) as resumed:
        assert resumed.wait(LIMIT) == 0
    assert_same(rd.load_solution(out), alone())


@pytest.mark.skipif(shutil.which("openssl") is None, reason="no openssl to make certificates with")
def test_tls(tmp_path):
    key, cert, out = tmp_path / "key.pem", tmp_path / "cert.pem", tmp_path / "run.npz"
    subject = ["-subj", "/CN=radiosity", "-addext", "subjectAltName=IP:127.0.0.1"]
    make = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", *subject, "-keyout", key, "-out", cert]
    subprocess.run(make, check=True, capture_output=True)
    begin = "DASK_DISTRIBUTED__COMM__TLS__"
    tls = {f"{begin}CA_FILE": str(cert)}
    for part in ("CLIENT", "SCHEDULER", "WORKER"):
        tls |= {f"{begin}{part}__KEY": str(key), f"{begin}{part}__CERT": str(cert)}
    with Processes(2, "--protocol", "tls", env=tls) as processes:
        assert processes.address.startswith("tls://")
        with program(*SOLVE, "--cluster", processes.address) as without:  # no certificates
            assert without.wait(LIMIT) == 1
            assert "certificates" in without.stderr.read()
        with program(*SOLVE, "--cluster", processes.address, "-o", str(out), env={**os.environ, **tls}) as encrypted:
            assert encrypted.wait(LIMIT) == 0
    assert_same(rd.load_solution(out), alone())
