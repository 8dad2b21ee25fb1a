"""Which run a checkpoint belongs to: a lock of the system on the file, which goes with its process, however that ends."""

import os
from contextlib import suppress
from pathlib import Path

try:
    import fcntl
except ImportError:  # Windows has none: there runs do not know of each other
    fcntl = None


class Hold:
    """The lock of a run on the checkpoint that it has written last.

    Locks are those of a process (POSIX): a run does not hinder a later one of the same process. To read the file in this process
    lets go of it until it is written again.
    """

    def __init__(self):
        self._handle: int | None = None

    def __del__(self):
        self.drop()

    def take(self, path: Path) -> None:
        """Lock the file that now stands at ``path``, and let go of the one before; nothing where the system has no such locks."""
        self.drop()
        if fcntl is not None:
            with suppress(OSError, ValueError):
                self._handle = os.open(path, os.O_RDWR)
                fcntl.lockf(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def drop(self) -> None:
        """Let go of the file."""
        handle, self._handle = self._handle, None
        if handle is not None:
            os.close(handle)

    def has(self, path: Path) -> bool:
        """Return whether the file at ``path`` is the one of this lock."""
        with suppress(OSError, ValueError):
            return self._handle is not None and os.path.samestat(os.fstat(self._handle), path.stat())
        return False


def held(path: Path) -> bool:
    """Return whether a run of another process holds the file; False where that cannot be told, or there is no file."""
    if fcntl is None:
        return False
    try:
        file = path.open("rb+")
    except (OSError, ValueError):
        return False
    with file:
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except (BlockingIOError, PermissionError):
            return True
        except OSError:  # a file system without locks
            return False
    return False


def free_name(path: Path) -> Path:
    """Return a name beside ``path`` at which there is no file: ``box.checkpoint.npz`` -> ``box.checkpoint-2.npz``."""
    number = 2
    while (other := path.with_name(f"{path.stem}-{number}{path.suffix}")).exists():
        number += 1
    return other
