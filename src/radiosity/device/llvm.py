"""Finding a libLLVM that Dr.Jit can use, before Dr.Jit looks for one: with an old one it ends the whole process.

Dr.Jit loads libLLVM when it is imported, for every Mitsuba variant. So importing this package already points Dr.Jit to a good
library (`point`, by name only), and `prepare` checks which one was loaded.
"""

import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

from ..errors import DeviceError

VARIABLE = "DRJIT_LIBLLVM_PATH"
OLDEST = 19  # the oldest release that was tested; 15 ends the process ("Cannot select ... fmaximum")
POINTED: str | None = None  # the value of the variable where this package, and not the user, set it
ADVICE = (
    f"install one of version {OLDEST} or newer (on Linux x86-64: pip install karellen-llvm-core; elsewhere LLVM's own "
    f"package, such as libllvm{OLDEST} or 'brew install llvm') and set {VARIABLE} to the path of its libLLVM"
)


class Library(NamedTuple):
    """A libLLVM: path, major version (0: unknown) and what chose it."""

    path: Path
    version: int
    origin: str


def point() -> None:
    """Set the variable that Dr.Jit reads to the most likely library, unless it is set or Dr.Jit is loaded already."""
    global POINTED
    likeliest = next((str(path) for path, _ in _candidates() if _number(path.name) >= OLDEST), None)
    if likeliest and VARIABLE not in os.environ and "drjit" not in sys.modules:
        os.environ[VARIABLE] = likeliest
    if likeliest and os.environ.get(VARIABLE) == likeliest:
        POINTED = likeliest  # also where a parent process that runs this program has set it


def prepare() -> Library:
    """Return the library that Dr.Jit uses, or will use.

    Raises:
        DeviceError: there is none, it is too old, or Dr.Jit was imported first and took an old one.
    """
    global POINTED
    if "drjit" not in sys.modules:
        library = find()
        if library.origin != VARIABLE:
            os.environ[VARIABLE] = POINTED = str(library.path)
        return library
    import drjit as dr

    loaded = dr.detail.llvm_version()
    number = re.match(r"\d+", str(loaded[0] if isinstance(loaded, tuple) else loaded))
    major = int(number.group()) if number else 0
    if major < OLDEST:
        library = find()  # says what to install where there is none
        if POINTED and os.environ.get(VARIABLE) == POINTED:
            other = "" if str(library.path) == POINTED else f"; {library.path} seems usable"
            raise DeviceError(f"Dr.Jit cannot use {POINTED}, which was found first{other}; set {VARIABLE} to another libLLVM")
        raise DeviceError(
            f"drjit was imported before radiosity and loaded libLLVM {major or 'none'}, which is too old; "
            f"import radiosity first, or set {VARIABLE}"
        )
    path = os.environ.get(VARIABLE)
    if path is None:
        return Library(Path("libLLVM"), major, "found by Dr.Jit")
    return Library(Path(path), major, _origin(path) if path == POINTED else VARIABLE)


@cache
def _origin(path: str) -> str:
    """Return where a library was found; to look through the folders takes milliseconds, and runs ask again and again."""
    return next((origin for candidate, origin in _candidates() if str(candidate) == path), VARIABLE)


def find() -> Library:
    """Return the library to use: the user's setting, that of the wheel in this environment, or that of the system.

    Raises:
        DeviceError: there is none, or it is too old; the message says what to install and what to set.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen and chosen != POINTED:
        library = Library(Path(chosen), version(Path(chosen)), VARIABLE)
        return _young_enough(library)
    for path, origin in _candidates():
        library = Library(path, version(path), origin)
        if library.version >= OLDEST:
            return library
    raise DeviceError(f"no usable libLLVM found (Dr.Jit compiles its kernels with it); {ADVICE}")


def _candidates() -> Iterator[tuple[Path, str]]:
    for folder, origin in _folders():
        for path in sorted(folder.glob(_pattern()), key=lambda p: (-_number(p.name), len(p.name))):
            yield path, origin


def _young_enough(library: Library) -> Library:
    if library.version == 0:
        raise DeviceError(f"{library.origin} names {library.path}, which is no loadable libLLVM; {ADVICE}")
    if library.version < OLDEST:
        raise DeviceError(f"libLLVM {library.version} ({library.path}) is too old; {ADVICE}")
    return library


def _pattern() -> str:
    return {"darwin": "libLLVM*.dylib", "win32": "LLVM-C*.dll"}.get(sys.platform, "libLLVM*.so*")


def _folders() -> Iterator[tuple[Path, str]]:
    """Yield folders, that of the wheel first; others only where it has none, so that importing the package is quick."""
    # a user's own install (pip install --user) keeps the wheel's files under site-packages' prefix
    own = [Path(entry).parents[2] for entry in sys.path if entry.endswith("site-packages")]
    for folder in (Path(sys.prefix) / "lib", Path(sys.prefix) / "Library" / "bin", *own):
        if folder.is_dir():
            yield folder, "wheel"
    system = ["/usr/lib64", "/usr/lib", "/usr/local/lib", "/opt/homebrew/opt/llvm/lib", "/usr/local/opt/llvm/lib"]
    found = [*map(Path, system), *sorted(Path("/usr/lib").glob("*-linux-gnu"))]
    found += sorted(Path("/usr/lib").glob("llvm-*/lib"), reverse=True)
    for folder in found:
        if folder.is_dir():
            yield folder, "system"


def _number(name: str) -> int:
    match = re.search(r"(?:LLVM-|so\.|C)(\d+)", name)
    return int(match.group(1)) if match else 0


def version(path: Path) -> int:
    """Return the major version of a libLLVM, 0 where it cannot be loaded.

    Libraries older than LLVM 16 do not tell it. The file's name may; otherwise 15 is assumed.
    """
    import ctypes

    try:
        library = ctypes.CDLL(str(path))
    except OSError:
        return 0
    if not hasattr(library, "LLVMContextCreate"):
        return 0
    if not hasattr(library, "LLVMGetVersion"):
        return min(_number(path.name) or 15, 15)
    major, minor, patch = ctypes.c_uint(), ctypes.c_uint(), ctypes.c_uint()
    library.LLVMGetVersion(ctypes.byref(major), ctypes.byref(minor), ctypes.byref(patch))
    return major.value
