"""Find a libLLVM that Dr.Jit can use, before Dr.Jit looks for one: with an old one it ends the whole process.

Dr.Jit loads libLLVM when it is imported, whatever Mitsuba variant is used later. So importing this package already
points it to a good library (`point`, by name only), and `prepare` checks what was really loaded.
"""

import ctypes
import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path

from .errors import DeviceError

VARIABLE = "DRJIT_LIBLLVM_PATH"
OLDEST = 19  # the oldest release that was tested; 15 ends the process ("Cannot select ... fmaximum")
ADVICE = (
    f"install one of version {OLDEST} or newer (on Linux x86-64: pip install karellen-llvm-core; elsewhere LLVM's own "
    f"package, such as libllvm{OLDEST} or 'brew install llvm') and set {VARIABLE} to the path of its libLLVM"
)


@dataclass(frozen=True)
class Library:
    """A libLLVM: path, major version (0: unknown) and who chose it."""

    path: Path
    version: int
    origin: str


def point() -> None:
    """Set the variable that Dr.Jit reads to the likeliest library, unless it is set or Dr.Jit is loaded already."""
    if VARIABLE in os.environ or "drjit" in sys.modules:
        return
    for path, _ in _candidates():
        if _number(path.name) >= OLDEST:
            os.environ[VARIABLE] = str(path)
            return


def prepare() -> Library:
    """The library that Dr.Jit uses, or will use.

    Raises:
        DeviceError: there is none, it is too old, or Dr.Jit was imported first and took an old one.
    """
    if "drjit" not in sys.modules:
        library = find()
        os.environ[VARIABLE] = str(library.path)
        return library
    import drjit as dr

    loaded = dr.detail.llvm_version()
    number = re.match(r"\d+", str(loaded[0] if isinstance(loaded, tuple) else loaded))
    major = int(number.group()) if number else 0
    if major < OLDEST:
        find()  # says what to install where there is none
        raise DeviceError(
            f"drjit was imported before radiosity and loaded libLLVM {major or 'none'}, which is too old; "
            f"import radiosity first, or set {VARIABLE}"
        )
    return Library(Path(os.environ.get(VARIABLE, "libLLVM")), major, "loaded")


def find() -> Library:
    """The library to use: the user's setting, the wheel's in this environment, or the system's.

    Raises:
        DeviceError: there is none, or it is too old; the message says what to install and what to set.
    """
    chosen = os.environ.get(VARIABLE)
    if chosen:
        library = Library(Path(chosen), version(Path(chosen)), VARIABLE)
        return _young_enough(library)
    for path, origin in _candidates():
        library = Library(path, version(path), origin)
        if library.version >= OLDEST:
            return library
    raise DeviceError(f"no usable libLLVM found (Dr.Jit compiles its kernels with it); {ADVICE}")


def _candidates() -> list[tuple[Path, str]]:
    found = []
    for folder, origin in _folders():
        found += [(p, origin) for p in sorted(folder.glob(_pattern()), key=lambda p: (-_number(p.name), len(p.name)))]
    return found


def _young_enough(library: Library) -> Library:
    if library.version == 0:
        raise DeviceError(f"{library.origin} names {library.path}, which is no loadable libLLVM; {ADVICE}")
    if library.version < OLDEST:
        raise DeviceError(f"libLLVM {library.version} ({library.path}) is too old; {ADVICE}")
    return library


def _pattern() -> str:
    return {"darwin": "libLLVM*.dylib", "win32": "LLVM-C*.dll"}.get(sys.platform, "libLLVM*.so*")


def _folders() -> list[tuple[Path, str]]:
    system = ["/usr/lib64", "/usr/lib", "/usr/local/lib", "/opt/homebrew/opt/llvm/lib", "/usr/local/opt/llvm/lib"]
    folders = [(Path(sys.prefix) / "lib", "wheel"), (Path(sys.prefix) / "Library" / "bin", "wheel")]
    # a user's own install (pip install --user) keeps the wheel's files under site-packages' prefix
    folders += [(Path(entry).parents[2], "wheel") for entry in sys.path if entry.endswith("site-packages")]
    found = [*folders, *((Path(f), "system") for f in system)]
    found += [(f, "system") for f in sorted(Path("/usr/lib").glob("*-linux-gnu"))]
    found += [(f, "system") for f in sorted(Path("/usr/lib").glob("llvm-*/lib"), reverse=True)]
    return [(folder, origin) for folder, origin in found if folder.is_dir()]


def _number(name: str) -> int:
    match = re.search(r"(?:LLVM-|so\.|C)(\d+)", name)
    return int(match.group(1)) if match else 0


def version(path: Path) -> int:
    """Major version of a libLLVM, 0 where it cannot be loaded.

    Before LLVM 16 a library could not say; the file's name may, and otherwise 15 is assumed.
    """
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
