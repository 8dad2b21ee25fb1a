"""Read damaged files first to last of a format; say each number before, and what came out that should not, on stdout.

``python worker.py FORMAT FIRST LAST MEGABYTES``: lines are ``at NUMBER`` before a file, then ``got NUMBER RESULT`` or
``found NUMBER TEXT``, and at the end ``done LAST``.
Memory is bounded to MEGABYTES beyond what the libraries take.
"""

import os
import resource
import sys
import tempfile
import traceback
import warnings
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # samples
from seeds import damaged

import radiosity as rd
from radiosity.errors import RadiosityError, RadiosityWarning

NET = "; is it damaged?"  # the end of what the last net for exceptions of others says, with their class before
MEMORY = "too large for the memory"


def take(files: dict[str, bytes], folder: Path) -> str:
    """What became of it: "read", or the class of our own error; anything else is raised.

    Raises:
        AssertionError: it was read and makes no sense.
        Exception: whatever the reader let through.
    """
    for name, data in files.items():
        (folder / name).write_bytes(data)
    path = next(folder / name for name in files if name.startswith("scene."))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", RadiosityWarning)
        warnings.simplefilter("ignore", DeprecationWarning)
        warnings.simplefilter("ignore", ResourceWarning)
        try:
            if path.suffix == ".npz":
                found = rd.load_lines(path).solve(1.0, 0.5) if "lines" in path.name else rd.load_solution(path)
                assert found.radiosity.shape == found.standard_error.shape == found.irradiance.shape
                assert found.report()
                return "read"
            patches = rd.subdivide(rd.load_scene(path), cells=1)
        except RadiosityError as error:
            return f"{type(error).__name__}{_kind(str(error))}"
    assert ((patches.reflectance >= 0) & (patches.reflectance < 1)).all(), "reflectance"
    assert np.isfinite(patches.emission).all(), "emission is not finite"
    assert (patches.emission >= 0).all(), "emission is negative"
    assert np.isfinite(patches.area).all(), "area is not finite"
    assert (patches.area > 0).all(), "area is not positive"
    return "read"


def _kind(message: str) -> str:
    if NET in message:
        return " by the last net"
    return " for memory" if MEMORY in message else ""


def bound_memory(megabytes: int) -> None:
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * os.sysconf("SC_PAGE_SIZE") + (megabytes << 20)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def main(name: str, first: int, last: int, megabytes: int) -> None:
    said = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # what libraries print is not for the parent
    with tempfile.TemporaryDirectory(prefix="fuzz") as folder:
        take(damaged(name, first), Path(folder))  # what it imports is there before memory is bounded
        bound_memory(megabytes)
        for number in range(first, last):
            print("at", number, file=said)
            try:
                result = take(damaged(name, number), Path(folder))
            except Exception as error:
                place = traceback.extract_tb(error.__traceback__)[-1]
                text = f"{type(error).__name__}: {str(error)[:200]} ({Path(place.filename).name}:{place.lineno})"
                print("found", number, " ".join(text.split()), file=said)
            else:
                print("got", number, result, file=said)
    print("done", last, file=said)


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:5]))
