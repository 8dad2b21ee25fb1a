"""The display mesh of a density estimation: fits evaluated at vertices, and cells merged where the eye sees no difference.

It follows B. Walter et al. 1997. Cells of a parallelogram are merged to blocks of 2 x 2, 4 x 4 and so on, as long as the values
left out lie within a tolerance of what is interpolated between the corners. Blocks of one face may differ in size: their edges
lie in one plane, so no crack opens.
"""

from dataclasses import replace

import numpy as np

from ..solution.local_linear import CORNER, Regions, weights
from .display_mesh import DisplayMesh, build

TOLERANCE = 0.02  # of the value: the least difference of brightness that people see side by side


def estimated(solution) -> bool:
    """Return whether the solution is a density estimation whose state still has its hits."""
    choices = getattr(solution, "provenance", {}).get("choices", {})
    return choices.get("reconstruction") == "local-linear" and "arrivals" in solution.state


def at_vertices(solution, mesh: DisplayMesh) -> tuple[DisplayMesh, np.ndarray]:
    """Fit irradiance at the vertices of a mesh; return the mesh with a vertex for each flat region, and (n_vertices, n_bands).

    The fit at a vertex uses the hits of its own region only.
    """
    patches = solution.patches
    regions = Regions.find(patches)
    key = mesh.polygons.astype(np.int64) * regions.count + regions.of[:, None]
    kept, polygons = np.unique(key, return_inverse=True)
    vertices = mesh.vertices[kept // regions.count]
    smooth = weights(regions, solution.arrivals, vertices, kept % regions.count, least=CORNER)
    counted = _counted(solution)
    return replace(mesh, vertices=vertices, polygons=polygons.reshape(mesh.polygons.shape).astype(np.int32)), smooth @ counted


def display(solution, quantity: str) -> tuple[DisplayMesh, np.ndarray, np.ndarray]:
    """Return the mesh to show of a density estimation.

    Args:
        quantity: radiosity or irradiance.

    Returns:
        The mesh, (n_vertices, n_bands) values, and the (n_polygons,) patch that each polygon begins with.
    """
    mesh, values = at_vertices(solution, build(solution.patches))
    if quantity == "radiosity":
        patches = solution.patches
        values = mesh.smoothed(patches.emission) + mesh.smoothed(patches.reflectance) * values
        if patches.diffuse_transmittance is not None:  # what comes from the other sides, in means over patches
            values += mesh.smoothed(patches.diffuse_transmittance * solution.irradiance[patches.other_side])
    mesh, patch = merged(solution, mesh, values)
    used, polygons = np.unique(mesh.polygons, return_inverse=True)
    polygons = polygons.reshape(mesh.polygons.shape).astype(np.int32)
    return replace(mesh, vertices=mesh.vertices[used], polygons=polygons), values[used], patch


def _counted(solution) -> np.ndarray:
    """Return irradiance as counted, before it was smoothed, mean over replicates, (n_patches, n_bands)."""
    from ..algorithms.state import Sizes
    from ..algorithms.walks.state import WalkState
    from ..algorithms.walks.tally import WalkTally
    from ..problem.model import Problem
    from ..run.snapshot import Snapshot

    collisions = solution.provenance["choices"]["estimator"] == "collision"
    counted = WalkTally(collisions, solution.provenance["choices"]["absorption"] == "fractional")
    problem = Problem.of(solution.patches)
    state = WalkState.read(solution.state, Sizes(solution.replicates, *problem.rows.emission.shape))
    return Snapshot(problem, counted, state).irradiance[0]


def merged(solution, mesh: DisplayMesh, values: np.ndarray, tolerance: float = TOLERANCE) -> tuple[DisplayMesh, np.ndarray]:
    """Return a mesh with fewer polygons whose interpolated values differ by at most about ``tolerance``; unused vertices stay.

    Args:
        values: (n_vertices, n_bands) to compare.

    Returns:
        The mesh, and the (m,) int64 patch that each of its polygons begins with.
    """
    patches = solution.patches
    polygons, first = [mesh.polygons], [np.arange(len(patches))]
    keep = np.ones(len(patches), bool)
    size = patches.cells_per_face
    for face in np.flatnonzero(patches.scene.is_quad & (size > 1)):
        shape = (patches.rows[face], patches.columns[face])
        for begin in range(patches.first[face], patches.first[face + 1], size[face]):
            blocks, owner = _blocks(mesh.polygons[begin : begin + size[face]].reshape(*shape, 4), values, tolerance)
            keep[begin : begin + size[face]] = False
            polygons.append(blocks)
            first.append(owner + begin)
    polygons[0], first[0] = mesh.polygons[keep], first[0][keep]
    patch = np.concatenate(first)
    shape = np.concatenate(polygons).astype(np.int32)
    return DisplayMesh(mesh.vertices, shape, np.zeros(shape.shape, np.float32), mesh.surface[patch]), patch


def _blocks(cells: np.ndarray, values: np.ndarray, tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return polygons of blocks of a face's cells, (m, 4), and the first cell of each; ``cells`` is (rows, columns, 4)."""
    rows, columns = cells.shape[:2]
    alone, result, owner = np.ones((rows, columns), bool), [], []
    step, corners = 1, cells
    while True:
        half = (rows // (2 * step), columns // (2 * step))
        whole = np.zeros(alone.shape, bool)
        if min(half) > 0:
            parts = [corners[i : 2 * half[0] : 2, j : 2 * half[1] : 2] for i in (0, 1) for j in (0, 1)]
            group = np.stack([alone[i : 2 * half[0] : 2, j : 2 * half[1] : 2] for i in (0, 1) for j in (0, 1)]).all(axis=0)
            joined = group & _even(parts, values, tolerance)
            whole[: 2 * half[0], : 2 * half[1]] = np.repeat(np.repeat(joined, 2, axis=0), 2, axis=1)
        left = np.argwhere(alone & ~whole)
        result.append(corners[left[:, 0], left[:, 1]])
        owner.append(left[:, 0] * step * columns + left[:, 1] * step)
        if min(half) == 0 or not joined.any():
            return np.concatenate(result), np.concatenate(owner)
        corners, alone, step = _outer(parts), joined, 2 * step


def _outer(parts: list[np.ndarray]) -> np.ndarray:
    """Return corners of blocks from those of their four parts: of each part, the corner that no other part has."""
    return np.stack([part[..., i] for i, part in enumerate(_around(parts))], axis=-1)


def _around(parts: list[np.ndarray]) -> tuple[np.ndarray, ...]:
    """Return the four parts of blocks in the order of their polygons' corners, which is reversed for backs."""
    low, right, up, far = parts
    return (low, right, far, up) if np.array_equal(low[..., 1], right[..., 0]) else (low, up, far, right)


def _even(parts: list[np.ndarray], values: np.ndarray, tolerance: float) -> np.ndarray:
    """Return a mask of blocks whose middle points lie within the tolerance of what their corners give."""
    corners = [values[corner] for corner in np.moveaxis(_outer(parts), -1, 0)]
    middle = values[parts[0][..., 2]]  # the vertex that all four parts share
    mean = sum(corners) / 4
    bound = tolerance * np.maximum(np.abs(mean), 1e-300)
    even = np.abs(middle - mean) <= bound
    for a, b in ((0, 1), (1, 2), (2, 3), (3, 0)):
        even &= np.abs(values[_between(parts, a, b)] - (corners[a] + corners[b]) / 2) <= bound
    return np.all(even, axis=-1)


def _between(parts: list[np.ndarray], a: int, b: int) -> np.ndarray:
    """Return the vertex halfway between two neighbouring outer corners."""
    return _around(parts)[a][..., b]
