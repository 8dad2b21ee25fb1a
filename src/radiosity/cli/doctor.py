"""``radiosity doctor``"""

import platform
import sys

from ..errors import INSTALL, DeviceError, installing

EXTRAS = {
    "formats": ("mapbox-earcut", "pyradiance", "pydantic"),
    "ifc": ("ifcopenshell",),
    "plots": ("matplotlib",),
    "lab": ("matplotlib", "xarray", "pandas"),
}
ALONE = ("ifc",)  # extras that `all` leaves out


def doctor() -> int:
    """Check that this machine can solve: LLVM, device, threads, versions, extras."""
    usable = True
    _line("ok", "Python", f"{platform.python_version()} ({sys.prefix})")
    try:
        from ..device import backend as device

        facts = device.describe()
        _one_line_of_work()
    except (DeviceError, ImportError, OSError) as error:
        usable = False
        _line("problem", "solver", f"{' '.join(str(error).split())}{_advice(error)}")
    else:
        for name, value in facts.items():
            _line("ok", name, value)
        _line("ok", "solver", "a line was traced")
    for extra, packages in EXTRAS.items():
        missing = [package for package in packages if _installed(package) is None]
        if missing:
            _line("absent", extra, f"{', '.join(missing)} not installed; {installing(extra) if extra in ALONE else INSTALL}")
        else:
            _line("ok", extra, ", ".join(f"{package} {_installed(package)}" for package in packages))
    return 0 if usable else 1


def _line(state: str, what: str, value) -> None:
    print(f"{state:<8} {what:<10} {value}")


def _advice(error: Exception) -> str:
    missing = error.name if isinstance(error, ModuleNotFoundError) else None
    return f"; pip install {missing}" if missing in ("drjit", "mitsuba") else ""


def _installed(package: str) -> str | None:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version(package)
    except PackageNotFoundError:
        return None


def _one_line_of_work() -> None:
    """Compile and run the smallest kernel there is: one line against one face.

    Raises:
        DeviceError: the line does not hit the face.
    """
    import numpy as np

    from ..scene import Scene
    from ..tracing.first_hits import first_hits

    scene = Scene.from_arrays([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], 0.5, 1.0)
    hits = first_hits(scene, np.array([[0.25, 0.25, 1.0]]), np.array([[0.0, 0.0, -1.0]]))
    if int(hits.face[0]) != 0:
        raise DeviceError("a test line missed the face in front of it; reinstall drjit and mitsuba, and report this")
