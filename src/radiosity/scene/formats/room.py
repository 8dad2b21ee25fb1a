"""Memory that reading a file takes: one that will not fit is refused by name before it is read, and the process is not killed."""

from pathlib import Path

from ...device import memory
from ...errors import SceneError

# bytes of memory for a byte of a file, at the least (docs/long-runs.md); others: 1
SHARES = {".stl": 6.0, ".obj": 8.0, ".mgf": 15.0, ".rad": 5.0}


def check_size(path: Path) -> None:
    """Refuse a file that by its size alone takes more memory than may be taken.

    Raises:
        SceneError: with both numbers.
    """
    size = path.stat().st_size
    refuse(path, SHARES.get(path.suffix.lower(), 1.0) * size, f"reading its {memory.size(size)} takes")


def refuse(
    path: Path, wanted: float, what: str, way_out: str = "take a coarser mesh, or parts of it", most: float | None = None
) -> None:
    """Refuse to read what will not fit in memory.

    Args:
        wanted: bytes.
        what: what takes them, and the verb, such as ``reading it takes``.
        most: bytes that may be taken, where they were asked for before.

    Raises:
        SceneError: more than the limit of `memory.room`.
    """
    most = memory.room() if most is None else most
    if wanted > most:
        raise SceneError(
            f"{path}: {what} about {memory.size(wanted)} of memory, and {memory.size(most)} may be taken; {way_out} "
            f"({memory.VARIABLE}=16G or none sets another limit)"
        )
