"""Connections to a Dask scheduler: one that exists, a client that the caller has, or workers on this machine."""

import logging
import multiprocessing
import os
from asyncio import CancelledError
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib.util import find_spec
from typing import Any

from ..device.backend import same_threads
from ..errors import DeviceError, MethodError, installing
from .gpus import environments
from .scenes import forget_scenes

LOCAL = "local:"
PROTOCOLS = ("tcp://", "tls://", "ucx://", "ws://", "wss://", "inproc://")
QUIET = {  # what Dask does for its pages, which nobody looks at: 3 % of each core without it
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "500ms",
    "distributed.admin.system-monitor.interval": "2s",
}
TIMEOUT = 15.0  # seconds to reach a scheduler
# Other programs of the process do not compute on our clients. Dask would let them, and leave that so where no scheduler answers.
OWN = {"set_as_default": False}
GUARD = (
    "Processes on this machine import the script that starts them: its own work must stand under `if __name__ == '__main__':` "
    "(docs/cluster.md)"
)
FORMS = "give the address of a scheduler (tcp://HOST:PORT, tls://HOST:PORT), or local:N for N processes on this machine"


@contextmanager
def connected(cluster: Any) -> Iterator[Any]:
    """Yield a `distributed.Client`: the one that is given, or one that is made here and closed at the end.

    Args:
        cluster: an address, "local:N", or a client.

    Raises:
        DeviceError: 'distributed' is not installed, or no scheduler answers. MethodError: it is none of these.
    """
    with _client(cluster) as client, same_threads():  # workers that are threads of this process leave theirs
        try:
            yield client
        finally:
            forget_scenes(client)


@contextmanager
def _client(cluster: Any) -> Iterator[Any]:
    if find_spec("distributed") is None:
        raise DeviceError(f"cluster {_named(cluster)} needs 'distributed', which is not installed; {installing('cluster')}")
    from distributed import Client

    if isinstance(cluster, Client):
        if cluster.asynchronous:
            raise MethodError("cluster: the client is asynchronous; give one that was made without asynchronous=True")
        yield cluster
    elif isinstance(cluster, str) and cluster.startswith(LOCAL):
        with _local(_count(cluster)) as client:
            yield client
    elif isinstance(cluster, str) and cluster.startswith(PROTOCOLS):
        with _remote(cluster) as client:
            yield client
    else:
        raise MethodError(f"cluster is {cluster!r}; {FORMS}, or a distributed.Client")


def _named(cluster: Any) -> str:
    return f"'{cluster}'" if isinstance(cluster, str) else type(cluster).__name__


def _count(cluster: str) -> int:
    text = cluster.removeprefix(LOCAL)
    if not text.isdecimal() or int(text) < 1:
        raise MethodError(f"cluster is '{cluster}'; write local:N with a number N of processes, 1 or more")
    return int(text)


@contextmanager
def _local(workers: int) -> Iterator[Any]:
    """Start processes on this machine, which share its cores, and take one of its GPUs each."""
    import dask.config
    from distributed import Client, LocalCluster

    threads = max(1, _cores() // workers)
    # no limit of Dask's own: it would stop a worker at a share of the memory; a run estimates what it takes beforehand
    options = {"memory_limit": 0, "dashboard_address": "127.0.0.1:0", "silence_logs": logging.CRITICAL}
    if getattr(multiprocessing.current_process(), "_inheriting", False):  # a worker that runs the caller's script
        raise DeviceError(GUARD)
    with dask.config.set(QUIET):
        try:
            cluster = LocalCluster(n_workers=workers, threads_per_worker=threads, worker_class=_started(workers), **options)
        except RuntimeError as error:
            raise DeviceError(f"cluster 'local:{workers}': its processes do not start ({_why(error)}). {GUARD}") from None
        with cluster, Client(cluster, **OWN) as client:
            yield client


def _started(workers: int) -> type:
    """Return Dask's class that starts a process of a local cluster, with an environment of its own each."""
    from distributed import Nanny

    given = environments(workers)

    class OneGpu(Nanny):
        def __init__(self, *of, name=None, env=None, **options):
            super().__init__(*of, name=name, env={**(env or {}), **given[int(str(name)) % workers]}, **options)

    return OneGpu


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def _remote(address: str) -> Iterator[Any]:
    from distributed import Client

    try:
        client = Client(address, timeout=TIMEOUT, **OWN)
    except (OSError, ValueError, TypeError) as error:  # refused, no such host, another protocol, certificates
        raise DeviceError(
            f"cluster '{address}': no scheduler answers ({_why(error)}); is it running (`dask scheduler`), and is the address "
            "the one that it prints? tls:// needs the certificates of Dask's configuration (docs/cluster.md)"
        ) from None
    try:
        yield client
    finally:
        with suppress(Exception):  # the scheduler may have gone
            client.close(timeout=2)


def _why(error: BaseException) -> str:
    """Return the first cause in words."""
    while (inner := error.__cause__ or error.__context__) is not None:
        error = inner
    if isinstance(error, (CancelledError, TimeoutError)):
        return f"nothing within {TIMEOUT:g} s"
    return " ".join(str(error).split())[:200] or type(error).__name__
