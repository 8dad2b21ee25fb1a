"""Meshes that follow the light: faces are cut where light varies over them, within a number of patches.

First faces are cut along contact lines, and along edges of shadows. Then pilot runs see, with each patch cut into up to four,
where the cells of a patch differ by more than noise, and what a second cut gains (`patches/ahead.py`). The patches are cut that
gain most for each patch that is added, and so on, until there are as many as asked for. The run itself starts anew on that mesh,
so that its bits are a function of seed and inputs.
"""

from dataclasses import replace

import numpy as np

from ..device.memory import limited
from ..device.turn import turn
from ..errors import MethodError, SceneError, untold
from ..method import Method, resolve
from ..patches import Patches, subdivide
from ..patches.ahead import mean_over, quarters_of, within_halves
from ..patches.bases import BASES
from ..patches.cells_as_faces import cells_as_faces, turned
from ..patches.contact import cut_at_contacts
from ..patches.halves import Halves
from ..patches.left_out import CELLS, variation
from ..patches.variation import Variation
from ..scene.model import Back, Scene
from .progress import Listener
from .shadows import shadow_lines
from .solve import prepared
from .whole_number import whole

START = 16  # the first mesh has so many times fewer patches
GROWTH = 1.6  # from one pilot to the next, of patches beyond one for each side of a face
NEAR = 0.1  # of a patch's size: outlines of what is nearer to a face are contact lines
CUTS = 8  # contact lines add at most the number of patches over this
SHADOWS = 16  # likewise edges of shadows
LEAST = 64  # patches are cut until they are so many times smaller than the mean
LINES = 256  # of each cell of a pilot, replicates together
AHEAD = 100_000  # up to so many cells, a pilot cuts each of them again, with as many lines in all
REPLICATES = 4  # of pilots
APART = 1 << 20  # difference of the seeds of pilots and of the run, so that their errors are independent


def adapt(
    scene: Scene,
    patches: int | None = None,
    *,
    seed: int = 0,
    device: str = "auto",
    progress: Listener | None = None,
    memory: str | float | None = None,
    basis: str = "constant",
) -> Patches:
    """Cut a scene where light varies: along contact lines and edges of shadows, and near lamps.

    Every patch is a face of the scene of the patches (``patches.scene.cut`` says of which face each is a part). All methods but
    hierarchical radiosity, which refines by itself, take such patches.

    Args:
        scene: what to cut.
        patches: how many patches there may be; default: as many as `subdivide` makes of the scene.
        seed: with the same inputs, the same mesh.
        device, progress, memory: as of `solve`.
        basis: of the run on the mesh. With linear and quadratic, faces are cut where linear light leaves out most: of light that
            is linear on two cells, quadratic light leaves out so little that it tells less.

    Raises:
        SceneError: nothing emits, or the scene has more faces and sides than there may be patches. MethodError: a value that
            makes no sense. KeyboardInterrupt: Ctrl-C.

    Example:
        >>> patches = rd.adapt(rd.load_scene("room"), 60)
        >>> 50 < len(patches) <= 60, len(patches.scene.names) == len(rd.load_scene("room").names)
        (True, True)
    """
    if not isinstance(scene, Scene):
        raise MethodError(f"adapt takes a Scene, not {type(scene).__name__}: it cuts the faces anew; load a file with load_scene")
    count = len(subdivide(scene)) if patches is None else whole(patches, "patches", 1)
    least = int(np.where(scene.back == Back.RADIATES, 2, 1).sum())
    if least > count:
        raise SceneError(
            f"{scene.source}: {count} patches are fewer than its {least} sides of faces; ask for {least} or more, or leave out "
            "the number"
        )
    number = whole(seed, "seed", 0)
    if basis not in BASES:
        raise MethodError(f"basis '{basis}' is not known; known are {', '.join(BASES)}")
    polynomials = BASES[basis]
    method = _of_polynomials(scene) if polynomials.size > 1 else None
    with limited(memory), turn():
        small = float(scene.area.sum()) / count / LEAST
        current = _first(scene, count, least, device)
        expected: Variation | None = None
        for step in range(1, 64):
            halves = Halves.of(current, small)
            here = len(halves.coarse)
            more = min(int((here - least) * (GROWTH - 1)) + 1, count - here)
            if more <= 0:
                break
            ahead = polynomials.size == 1 and len(halves.fine) <= AHEAD
            pilot = quarters_of(halves) if ahead else halves.fine
            light, method = _pilot(pilot, LINES * len(halves.fine), method, number + step * APART, device, progress)
            within = within_halves(halves, pilot, light[..., 0]) if ahead else None
            light = mean_over(pilot, light[..., 0], halves.fine)[..., None] if ahead else light
            seen = halves.variation(light[..., 0], within) if polynomials.size == 1 else variation(halves, light, CELLS)
            found = seen.given(expected)
            columns, rows = halves.chosen(found, more, halves.weights(light[..., 0]))
            if (columns * rows == 1).all():
                break
            current, part = _cut(current, columns, rows)
            expected = found.after(halves.coarse.scene, columns, rows, part, current.is_quad)
        one = np.ones(current.n_faces, np.int32)
        return Patches(current, one, one)


def _first(scene: Scene, count: int, least: int, device: str) -> Scene:
    """Return the scene cut along contact lines and edges of shadows, and evenly into few patches."""
    shadows, most = shadow_lines(scene, count, device), min(count // CUTS, (count - least) // 2)
    more = min(count // SHADOWS, (count - least) // 4)
    cut = turned(cut_at_contacts(scene, count, most, near=NEAR, shadows=shadows, more=more))
    if shadows and len(subdivide(cut, cells=1)) > count:
        cut = turned(cut_at_contacts(scene, count, most, near=NEAR))
    for about in (count // START, 1):
        even = subdivide(cut, about=max(about, 1))
        if len(even) <= count:
            return cells_as_faces(even)
    return cut


def _cut(scene: Scene, columns: np.ndarray, rows: np.ndarray) -> tuple[Scene, np.ndarray]:
    """Return the scene of the cells of faces, and the face of each."""
    result = cells_as_faces(Patches(scene, columns, rows))
    parts = np.where(scene.is_quad, columns * rows, columns * (columns + 1) // 2)
    return result, np.repeat(np.arange(scene.n_faces), parts)


def _pilot(
    patches: Patches, lines: int, method: Method | None, seed: int, device: str, progress: Listener | None
) -> tuple[np.ndarray, Method]:
    """Return the irradiance of each replicate, (replicates, n_patches, n_bands, K), and the method that the first pilot chose.

    With one randomisation for all patches, cells beside each other have nearly the same noise, which their difference is free of.
    """
    n = len(patches)
    with untold():  # the run on the mesh tells them
        run = prepared(
            patches,
            resolve("auto") if method is None else method,
            rays=lines,
            replicates=REPLICATES,
            seed=seed,
            device=device,
            progress=progress,
        )
        of_means = method is None or method.basis == "constant"
        run.also = lambda stage: stage.sums(np.arange(n), n)[0] / patches.area[:, None] if of_means else stage.moments()
        solution = run.solve()
    if solution.status == "interrupted":
        raise KeyboardInterrupt
    assert run.snapshot is not None
    assert isinstance(run.method, Method)
    found = replace(run.method, randomisation="shared") if run.method.machine == "gather" else run.method
    light = run.snapshot.asked
    return light[..., None] if light.ndim == 3 else light, found


def _of_polynomials(scene: Scene) -> Method:
    """Return the method of pilots that tell slopes on cells."""
    if np.isin(scene.back, (Back.PASSES, Back.OPEN)).any():  # a gather does not take them
        return Method(order="incremental", estimator="bidirectional", basis=CELLS.name)
    return Method(order="gather", basis=CELLS.name)
