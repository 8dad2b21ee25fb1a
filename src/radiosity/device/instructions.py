"""The instructions of this machine's processor that kernels are compiled for, by the names that LLVM gives them.

Dr.Jit asks LLVM for them and takes as many numbers a vector as they have room for; Embree looks for them by itself.
"""

from functools import cache

from . import llvm

KINDS = (("avx512", "avx512vl"), ("avx2", "avx2"), ("avx", "avx"), ("neon", "neon"))  # a name, and LLVM's; the widest first
UNKNOWN = "unknown"


@cache
def instructions() -> str:
    """Return the widest of the vector instructions that the processor has, a name of `KINDS`; ``unknown`` where it is not told.

    Raises:
        DeviceError: there is no LLVM.
    """
    import ctypes

    try:
        library = ctypes.CDLL(str(llvm.prepare().path))
        ask, free = library.LLVMGetHostCPUFeatures, library.LLVMDisposeMessage
    except (OSError, AttributeError):
        return UNKNOWN
    ask.restype, free.argtypes = ctypes.c_void_p, [ctypes.c_void_p]
    text = ask()
    found = widest(ctypes.string_at(text).decode()) if text else UNKNOWN
    free(text)
    return found


def widest(features: str) -> str:
    """Return the widest of the vector instructions in a list as LLVM gives it, such as ``+avx,+avx2,-avx512vl``.

    Example:
        >>> widest("+avx,+avx2,-avx512vl")
        'avx2'
    """
    there = features.split(",")
    return next((name for name, feature in KINDS if f"+{feature}" in there), UNKNOWN)
