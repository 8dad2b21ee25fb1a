"""Files of exporters: they are written under another name in the same folder, and then moved into place."""

import os
from contextlib import contextmanager, suppress
from pathlib import Path

from ..errors import OutputError, RadiosityError
from .whole import reason


@contextmanager
def replacing(path):
    """Give a path in the same folder to write to; the finished file then takes the place of ``path`` in one step.

    Raises:
        OutputError: the system refuses; nothing is left behind, and a file that was there stays as it was.
    """
    path = Path(os.path.realpath(path))
    temporary = beside(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield temporary
        temporary.replace(path)
    except RadiosityError:
        raise
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({reason(error)})") from error
    finally:
        with suppress(OSError):
            temporary.unlink()


def beside(path: Path) -> Path:
    """The hidden file of this process in the same folder that takes the place of ``path``."""
    return path.with_name(f".{path.stem}.{os.getpid()}.part{path.suffix}")
