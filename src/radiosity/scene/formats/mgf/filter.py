"""Radiance's `mgfilt` reduces MGF to faces: curved primitives become polygons, every colour an (x, y) chromaticity."""

import re
import shutil
import subprocess
import tempfile
import threading
from importlib.util import find_spec
from pathlib import Path

from ....errors import SceneError
from .faults import Faults, Statement, decode

UNDERSTOOD = "#,xf,o,c,cxy,m,sides,rd,td,ed,rs,ts,v,p,f"
MOST_RUNS = 200  # mgfilt stops at a fault: it is run again without that line
SECONDS = 120  # for one run
MOST_BYTES = 1 << 29  # of output
MOST_MEMORY = 4 << 30
FAULT = re.compile(rb"<stdin>: (\d+): ([^:\n]+)")
# what stands for a faulty statement, so that what follows does not change the context before it
INSTEAD = {b"c": b"c", b"v": b"v"}


def reduce_to_faces(statements: list[Statement], faults: Faults, source: str) -> list[bytes]:
    """Lines of the reduced description; ``# k`` comes before the lines that statement k became.

    Statements that mgfilt stops at are faults and left out.

    Raises:
        SceneError: mgfilt fails otherwise, or at very many lines.
        ModuleNotFoundError: pyradiance is not installed.
    """
    texts = [statement.text for statement in statements]
    for _ in range(MOST_RUNS):
        data = b"".join(b"# %d\n%s\n" % pair for pair in enumerate(texts))
        output, errors, status = _run(data, source)
        if status == 0:
            return output.splitlines()
        match = FAULT.search(errors)
        if match is None:
            text = decode(errors).strip()[:200] or f"status {status}"
            raise SceneError(f"{source}: mgfilt cannot read the file: {text}{faults.first()}")
        index = (int(match[1]) - 1) // 2
        fault = statements[index]
        faults.add(fault.place, f"{decode(match[2]).lower()} in '{decode(b' '.join(fault.text.split()))[:60]}'")
        instead = INSTEAD.get(fault.text.split()[0], b"#")
        for k, other in enumerate(statements):  # the same line where it is included again
            if other.line == fault.line and other.file == fault.file:
                texts[k] = instead
    raise SceneError(f"{source}: more than {MOST_RUNS} faulty lines{faults.first()}")


def program(name: str) -> str:
    """Path of one of Radiance's programs that come with pyradiance.

    Raises:
        ModuleNotFoundError: pyradiance is not installed.
        SceneError: it lacks the program.
    """
    spec = find_spec("pyradiance")
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError("No module named 'pyradiance'", name="pyradiance")
    folder = Path(spec.origin).parent / "bin"
    path = shutil.which(name, path=str(folder))
    if path is None:
        raise SceneError(f"Radiance's program '{name}' is not in {folder}; reinstall pyradiance")
    return path


def _bound(pid: int) -> None:
    """Limit the memory and processor time of a program that works on data of others, where the system can."""
    try:
        import resource

        resource.prlimit(pid, resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
        resource.prlimit(pid, resource.RLIMIT_CPU, (SECONDS, SECONDS))
    except (ImportError, AttributeError, OSError, ValueError):  # not Linux, ended already, or a stricter limit in force
        pass


def _run(data: bytes, source: str) -> tuple[bytes, bytes, int]:
    """The output, error text and status of one run, with bounds on time and output."""
    with tempfile.TemporaryFile() as given, tempfile.TemporaryFile() as errors:
        given.write(data)
        given.seek(0)
        process = subprocess.Popen(
            [program("mgfilt"), UNDERSTOOD], stdin=given, stdout=subprocess.PIPE, stderr=errors, env={}, cwd=tempfile.gettempdir()
        )
        _bound(process.pid)
        assert process.stdout is not None
        late = threading.Event()
        timer = threading.Timer(SECONDS, lambda: (late.set(), process.kill()))
        timer.start()
        chunks, size = [], 0
        try:
            while chunk := process.stdout.read(1 << 20):
                chunks.append(chunk)
                size += len(chunk)
                if size > MOST_BYTES:
                    raise SceneError(f"{source}: reduces to more than {MOST_BYTES >> 20} MiB of faces; split the scene")
        finally:
            timer.cancel()
            process.stdout.close()
            if process.poll() is None and size > MOST_BYTES:
                process.kill()
            status = process.wait()
        if status < 0 and not late.is_set():
            raise SceneError(
                f"{source}: mgfilt was ended by signal {-status} (it may take {MOST_MEMORY >> 30} GiB and {SECONDS} s); "
                "split the scene"
            )
        if late.is_set():
            raise SceneError(f"{source}: mgfilt did not finish in {SECONDS} s; split the scene")
        errors.seek(0)
        return b"".join(chunks), errors.read(1 << 16), status
