"""The memory limit of runs: a run that would take more is refused before it begins, and not killed in the middle."""

import math
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path

from ..errors import MethodError

VARIABLE = "RADIOSITY_MEMORY"  # such as 8G, or none for no limit
SHARE = 0.7  # of what is free
UNITS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}
_limit: ContextVar[float | None] = ContextVar("limit", default=None)  # of the run that goes on
PROC, GROUPS = Path("/proc"), Path("/sys/fs/cgroup")


def refuse(wanted: float, what: str, way_out: str) -> None:
    """Refuse what will not fit in memory.

    Raises:
        MethodError: more bytes are wanted than the limit allows.
    """
    most = room()
    if wanted <= most:
        return
    given = _given()
    by = VARIABLE if _limit.get() is None else "memory"
    there = f"{size(free())} are free" if given is None else f"{size(given)} are allowed ({by})"
    other = f" (--memory 16G or none, or {VARIABLE}, sets another limit)" if given is None else ""
    raise MethodError(f"{what} would take about {size(wanted)} of memory, and {there}; {way_out}{other}")


def size(number: float) -> str:
    """Return a number of bytes as text, such as ``1.5 GiB``."""
    unit, name = (2**30, "GiB") if number >= 2**29 else (2**20, "MiB")
    return f"{number / unit:.3g} {name}"


def room() -> float:
    """Return the bytes that a run may take: the given limit, or a share of what is free; infinite where nothing is known.

    Raises:
        MethodError: the variable is not a size.
    """
    given = _given()
    return SHARE * free() if given is None else given


def free() -> float:
    """Return the bytes that new arrays may take: what the system has, and what limits of control groups and of the process
    leave."""
    return max(0.0, min((_system(), *_groups(), _process()), default=math.inf))


@contextmanager
def limited(size: str | float | None):
    """Set the memory limit of runs in a block: a size such as "8G", a number of bytes, or "none"; None leaves it as it is.

    Raises:
        MethodError: it is not a size.
    """
    token = _limit.set(_limit.get() if size is None else _bytes("memory", size))
    try:
        yield
    finally:
        _limit.reset(token)


def _given() -> float | None:
    if (limit := _limit.get()) is not None:
        return limit
    text = os.environ.get(VARIABLE, "").strip()
    return _bytes(VARIABLE, text) if text else None


def _bytes(name: str, wanted: str | float) -> float:
    text = str(wanted).strip()
    if isinstance(wanted, int | float) and not isinstance(wanted, bool) and wanted >= 0:
        return float(wanted)
    if text.lower() == "none":
        return math.inf
    found = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([KMGT]?)(?:i?B)?", text, re.IGNORECASE)
    if not found:
        raise MethodError(f"{name} is '{text}'; give a size such as 8G or 500M, or none for no limit")
    return float(found[1]) * UNITS[found[2].upper()]


def _system() -> float:
    try:
        return 1024.0 * int(_facts(PROC / "meminfo", ":")["MemAvailable"].split()[0])
    except (OSError, KeyError, ValueError):
        pass
    try:
        return float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return math.inf


def _groups() -> Iterator[float]:
    """Yield the free bytes of each control group that the process is in, version 1 or 2, and of the groups around it.

    Above ``memory.max`` a process is killed, and above ``memory.high`` it is slowed down until it seems to hang.
    """
    try:
        lines = (PROC / "self/cgroup").read_text().splitlines()
    except (OSError, ValueError):
        return
    for line in lines:
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            folder, limits, names = GROUPS, ("memory.max", "memory.high"), ("memory.current", "inactive_file")
        elif "memory" in controllers.split(","):
            folder, limits = GROUPS / "memory", ("memory.limit_in_bytes",)
            names = ("memory.usage_in_bytes", "total_inactive_file")
        else:
            continue
        parts = [part for part in path.split("/") if part not in ("", "..")]
        for depth in range(len(parts) + 1):  # in a container the group may be called as it is outside, where we cannot look
            for limit in limits:
                yield _left(folder.joinpath(*parts[:depth]), limit, *names)


def _left(folder: Path, limit: str, used: str, cache: str) -> float:
    try:
        most, now = (folder / limit).read_text().strip(), int((folder / used).read_text())
        left = math.inf if most == "max" else float(int(most) - now)
    except (OSError, ValueError):
        return math.inf
    with suppress(OSError, KeyError, ValueError):
        left += min(now, int(_facts(folder / "memory.stat", " ")[cache]))  # files, which make room
    return left


def _process() -> float:
    try:
        import resource

        limit, _ = resource.getrlimit(resource.RLIMIT_AS)
        if limit == resource.RLIM_INFINITY:
            return math.inf
        return float(limit - 1024 * int(_facts(PROC / "self/status", ":")["VmSize"].split()[0]))
    except (ImportError, OSError, KeyError, ValueError):
        return math.inf


def _facts(path: Path, between: str) -> dict[str, str]:
    lines = path.read_text().splitlines()
    return dict(line.split(between, 1) for line in lines if between in line)
