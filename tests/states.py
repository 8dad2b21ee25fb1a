"""States of processes, for the suite of the orders: after stages, interrupted or not.

A method runs on a small open scene whose faces radiate on both sides in two bands; or, where it says that it cannot carry bands,
on one in grey with absorbing backs.
"""

import io
from functools import cache

import numpy as np
from iterations import open_room

import radiosity as rd
from radiosity.algorithms.base import AbstractAlgorithm, Interrupted
from radiosity.algorithms.state import AbstractState
from radiosity.algorithms.table import make
from radiosity.device.backend import choose, threads
from radiosity.problem.model import Problem
from radiosity.tracing.geometry import Geometry

STAGES = (1_000, 6_000)  # quanta; the first stage of a run is short
ODD = (1, 7, 1_000, 1_001, 3_000, 3_000, 6_000)
SUMS = 1e-12  # of sums in doubles, whose order is that of stages
MOST = 100  # interruptions


@cache
def grey() -> tuple[Geometry, Problem]:
    patches = rd.subdivide(open_room(), cells=2)
    return Geometry(patches, choose("cpu")), Problem.of(patches)


@cache
def coloured() -> tuple[Geometry, Problem]:
    scene = open_room()
    reflectance = np.column_stack([scene.reflectance[:, 0], scene.reflectance[::-1, 0] / 2])
    tinted = rd.Scene.from_arrays(
        scene.vertices,
        scene.faces,
        reflectance,
        scene.emission * [[1.0, 0.5]],
        surface=scene.surface,
        names=scene.names,
        bands=["one", "other"],
        two_sided=True,
        back_reflectance=0.4,
        back_emission=np.zeros((1, 2)),
    )
    patches = rd.subdivide(tinted, cells=2)
    return Geometry(patches, choose("cpu")), Problem.of(patches)


@cache
def scene_of(method: rd.Method) -> tuple[Geometry, Problem]:
    """The coloured one, unless the method refuses it."""
    try:
        rd.solve(coloured()[1].patches, method, quanta=1, replicates=1)
    except rd.MethodError:
        return grey()
    return coloured()


def begun(method: rd.Method, seed: int = 4) -> AbstractAlgorithm:
    return make(*scene_of(method), method, seed, 2)


def whole(method: rd.Method, stages=STAGES, seed: int = 4) -> AbstractState:
    """The state after these stages, never interrupted."""
    algorithm = begun(method, seed)
    for quanta in stages:
        algorithm.advance(quanta, lambda lines: None)
    return algorithm.capture()


@cache
def once(method: rd.Method) -> AbstractState:
    """The state after `STAGES`, which no test changes: on one thread, with launches of the usual size."""
    with threads(1):
        return whole(method)


def filed(state: AbstractState) -> dict[str, np.ndarray]:
    """Its arrays, through the bytes of an NPZ file."""
    file = io.BytesIO()
    np.savez(file, **state.arrays())
    file.seek(0)
    with np.load(file, allow_pickle=False) as read:
        return {name: read[name] for name in read.files}


def interrupted(method: rd.Method) -> tuple[AbstractState, int]:
    """The same, stopped wherever the process can be, each time saved, loaded and put into a new one; and how often."""

    def stop(lines):
        raise Interrupted("test")

    algorithm, stops = begun(method), 0
    for quanta in STAGES:
        while stops < MOST:
            try:
                algorithm.advance(quanta, stop)
                break
            except Interrupted:
                arrays = filed(algorithm.capture())
                stops += 1
                algorithm = begun(method)
                algorithm.restore(algorithm.read(arrays, algorithm.sizes))
                assert algorithm.quanta == quanta
    return algorithm.capture(), stops


def same(one: AbstractState, other: AbstractState, sums: float = 0.0) -> bool:
    """All arrays are equal; sums in doubles up to rounding."""
    ours, theirs = one.arrays(), other.arrays()
    return ours.keys() == theirs.keys() and all(
        np.array_equal(ours[name], theirs[name])
        or (sums > 0 and ours[name].dtype.kind == "f" and np.allclose(ours[name], theirs[name], rtol=sums, atol=0))
        for name in ours
    )
