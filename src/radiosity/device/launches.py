"""The size of the blocks in which Dr.Jit shares a launch among threads: 16 384 lanes, unless another size is set.

Where a lane has several lines, there are few lanes, and the times of their blocks differ much; so threads would wait for the
slowest. With smaller blocks they do not (measured with two threads and eight lines a lane: 12 % less time in the office).
"""

import ctypes
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import drjit as dr

BLOCKS = 16  # for each thread; with smaller blocks time grows by 5 % where faces are many and lines go to all of them
LEAST = 256  # lanes of a block; a thread takes some 20 microseconds for as many lines


@contextmanager
def shared(lanes: int):
    """Set, for the launches in a block, the block size that suits their number of lanes; on a CPU.

    Dr.Jit has no Python function for it. Where that of its C++ interface is not found, nothing is changed; results do not
    depend on it.
    """
    functions = _functions()
    if functions is None:
        yield
        return
    size, set_size = functions
    before = size()
    set_size(block(lanes, dr.thread_count(), before))
    try:
        yield
    finally:
        set_size(before)


def block(lanes: int, threads: int, most: int) -> int:
    """Return the lanes of a block: a power of two, since with any other number Dr.Jit ends the process."""
    wanted = max(lanes // (BLOCKS * threads), LEAST)
    return min(1 << (wanted.bit_length() - 1), most)


@cache
def _functions():
    """Return two functions, which read and set the number of lanes of a block; None where they are not found."""
    for path in Path(dr.__file__).parent.glob("*drjit-core*"):
        try:
            library = ctypes.CDLL(str(path))
            size, set_size = library._Z19jit_llvm_block_sizev, library._Z23jit_llvm_set_block_sizej
        except (OSError, AttributeError):
            continue
        size.argtypes, size.restype = (), ctypes.c_uint32
        set_size.argtypes, set_size.restype = (ctypes.c_uint32,), None
        return size, set_size
    return None
