"""Choosing and entering a Dr.Jit back end, and uploads from numpy to it. No other module does these."""

import os
import warnings
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from typing import Any

import numpy as np

from ..errors import DeviceError
from . import llvm
from .recorded import not_recorded
from .turn import turn

VARIANTS = {"cpu": "llvm_ad_rgb", "cuda": "cuda_ad_rgb"}
PACKET = 64  # kernels may read whole packets past an array's end: every upload is padded to this


@dataclass(frozen=True)
class Device:
    """A back end: its name (``cpu`` or ``cuda``), Mitsuba's variant, and Dr.Jit's module of array types."""

    name: str
    variant: str
    types: Any


def choose(name: str = "auto") -> Device:
    """Return the device called ``auto`` (CUDA where there is one), ``cpu`` or ``cuda``.

    Raises:
        DeviceError: the name is unknown, or there is no CUDA device, or no LLVM.
    """
    if name not in ("auto", *VARIANTS):
        raise DeviceError(f"device '{name}' does not exist; known are auto, {', '.join(VARIANTS)}")
    import drjit as dr

    if name == "cuda" and not dr.has_backend(dr.JitBackend.CUDA):
        raise DeviceError("device 'cuda': no NVIDIA driver or device was found; take --device cpu")
    if name == "auto":
        name = "cuda" if os.environ.get("CUDA_VISIBLE_DEVICES") != "" and dr.has_backend(dr.JitBackend.CUDA) else "cpu"
    if name == "cpu":
        llvm.prepare()
        import drjit.llvm.ad as types
    else:
        import drjit.cuda.ad as types
    return Device(name, VARIANTS[name], types)


def classes(device: Device) -> Any:
    """Return Mitsuba's classes in the device's variant, which every launch needs.

    The variant in force stays: to set another one and set it back takes 50 ms (measured), at every launch where a user has set
    one.
    """
    return import_module(f"mitsuba.{device.variant}")


@contextmanager
def entered(device: Device):
    """Enter Mitsuba in the device's variant, to make scenes; the variant found before is set again on leaving."""
    import mitsuba as mi

    if mi.variant() == device.variant:
        yield mi
        return
    before = mi.variant()
    _set(device.variant)
    try:
        yield mi
    finally:
        if before is not None:
            _set(before)


def _set(variant: str) -> None:
    """Set Mitsuba's variant, without a warning that tells users nothing.

    Each change loads modules of Mitsuba again. After some sixty changes Dr.Jit warns that they decorate functions more than
    1000 times.
    """
    import mitsuba as mi

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The AST-transforming decorator", RuntimeWarning)
        mi.set_variant(variant)


def upload(dtype, values: np.ndarray):
    """Copy a one-dimensional numpy array to a Dr.Jit array of type ``dtype``.

    A Dr.Jit array made directly from numpy may share its memory, and kernels read whole packets: at the end of a page that
    ends the process. So Dr.Jit is given a padded copy, which is gathered into its own memory.

    Raises:
        RecordedError: a loop is being recorded.
    """
    import drjit as dr

    not_recorded("an array is uploaded")
    values = np.ascontiguousarray(values).ravel()
    padded = np.zeros(len(values) // PACKET * PACKET + 2 * PACKET, values.dtype)
    padded[: len(values)] = values
    result = dr.gather(dtype, dtype(padded), dr.arange(dr.uint32_array_t(dtype), len(values)))
    dr.eval(result)
    dr.sync_thread()
    return result


def small(dtype, values):
    """Copy a few numbers to a Dr.Jit array of type ``dtype``, without a wait; only gathers may read it.

    Dr.Jit copies what it takes from a list at once, while `upload` waits for all kernels that were launched. A gather does not
    read past the end. A zero follows the numbers, since arrays of one entry would compile kernels of their own.

    Raises:
        RecordedError: a loop is being recorded.
    """
    not_recorded("an array is uploaded")
    return dtype([*np.ravel(values).tolist(), 0])


def frozen(array) -> np.ndarray:
    """Return the present values of a Dr.Jit array on the host, without a copy where it lies in host memory.

    A second handle holds the values: what a kernel writes into ``array`` later goes to a copy that Dr.Jit makes.
    """
    import drjit as dr

    not_recorded("an array is read")
    dr.eval(array)
    dr.sync_thread()
    return np.asarray(type(array)(array))


def give_back_memory() -> None:
    """Give back to the system the memory that Dr.Jit keeps for reuse."""
    import drjit as dr

    dr.sync_thread()
    dr.flush_malloc_cache()


@contextmanager
def threads(count: int, *, back: bool = True):
    """Set Dr.Jit's number of threads for a block.

    Args:
        back: set it back afterwards. Where this is done often, leave it: Dr.Jit takes threads away by waiting for their end, and
            once in some thousand times waits for ever, since a thread that sleeps is not woken (1.5.0).
    """
    import drjit as dr

    before = dr.thread_count()
    if count != before:
        dr.set_thread_count(count)
    try:
        yield
    finally:
        if back and count != before:
            dr.set_thread_count(before)


@contextmanager
def same_threads():
    """Set Dr.Jit's number of threads back after a block that may leave another one."""
    import drjit as dr

    before = dr.thread_count()
    try:
        yield
    finally:
        if dr.thread_count() != before:
            with turn():
                dr.set_thread_count(before)


@contextmanager
def bitmaps():
    """Give Dr.Jit two threads or more for a block that reads or writes EXR files by Mitsuba's `Bitmap`.

    With one thread, as on machines of one core, `Bitmap` waits for ever (Mitsuba 3.9.1, Dr.Jit 1.5.0).
    """
    import drjit as dr

    if dr.thread_count() > 1:
        yield
        return
    with turn(), threads(2):
        yield


def describe() -> dict[str, str]:
    """Return facts for ``radiosity doctor``."""
    library = llvm.prepare()
    import drjit as dr

    return {
        "LLVM": f"{library.version} ({library.path}, {library.origin})",
        "device": choose("auto").name,
        "CUDA": "found" if dr.has_backend(dr.JitBackend.CUDA) else "none",
        "threads": str(dr.thread_count()),
        "drjit": version("drjit"),
        "mitsuba": version("mitsuba"),
        "numpy": np.__version__,
    }
