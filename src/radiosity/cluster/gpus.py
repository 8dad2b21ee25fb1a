"""The GPUs of a machine among its workers: a process traces on the first one that it sees, so each must see another first."""

import ctypes
import os
import socket
import warnings
from collections import defaultdict
from typing import Any

from ..errors import RadiosityWarning

NAMES = "CUDA_VISIBLE_DEVICES"  # environment of a process: the GPUs that it sees, numbers or names
DRIVERS = ("libcuda.so.1", "libcuda.so", "nvcuda.dll")


def visible() -> list[str]:
    """Return the GPUs that this process may use, as `CUDA_VISIBLE_DEVICES` names them; none where there is no driver of CUDA."""
    count = _count()
    names = os.environ.get(NAMES, ",".join(map(str, range(count))))
    return names.replace(" ", "").split(",")[:count]


def environments(workers: int) -> list[dict[str, str]]:
    """Return what the environment of each of some workers on this machine must hold, so that they take one GPU each in turn."""
    there = visible()
    return [{NAMES: there[number % len(there)]} if there else {} for number in range(workers)]


def tell_of_shared(client: Any, device: str) -> None:
    """Warn where workers that are there trace on the same GPU, or leave one idle that this process may use.

    Args:
        device: the name of the device of the run; nothing is told of "cpu".
    """
    if device != "cuda":
        return
    of = defaultdict(list)
    for address, first in client.run(first_seen, on_error="ignore").items():
        of[first].append(address)
    for (host, name), addresses in of.items():
        if len(addresses) > 1:
            warnings.warn(
                f"{len(addresses)} workers on {host} trace on one GPU ({name}), and are no faster than one: "
                f"{', '.join(addresses)}. Start one worker for each GPU, each with a {NAMES} of its own (docs/cluster.md)",
                RadiosityWarning,
                stacklevel=2,
            )
    here = socket.gethostname()
    used = {name for host, name in of if host == here}
    if used and (idle := [name for name in visible() if name not in used]):
        warnings.warn(
            f"no worker traces on the GPUs {', '.join(idle)} of this machine: take local:{len(visible())}, or start more workers",
            RadiosityWarning,
            stacklevel=2,
        )


def first_seen() -> tuple[str, str]:
    """Return the machine of this process, and the GPU that it traces on."""
    return socket.gethostname(), os.environ.get(NAMES, "0").replace(" ", "").split(",")[0]


def _count() -> int:
    """Return the number of GPUs that the driver of CUDA shows this process."""
    for name in DRIVERS:
        try:
            driver = ctypes.CDLL(name)
        except OSError:
            continue
        count = ctypes.c_int(0)
        if driver.cuInit(0) == 0 and driver.cuDeviceGetCount(ctypes.byref(count)) == 0:
            return count.value
    return 0
