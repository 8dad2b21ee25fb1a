"""A photon loop as one writes it in Mitsuba by hand, for a grey room: what ``make bench-error`` calls ``photon-loop``.

Photons leave the lamp with cosine-distributed directions. Each hit is counted, and a patch's reflectance is the probability of
going on from the point that was hit. All is one loop of one kernel. A lane whose photon is absorbed takes the next one, so that
no lane waits for longer paths of others: that takes a fifth of the time less.
"""

from dataclasses import dataclass

import numpy as np
from error_formulas import squares

import radiosity as rd

LANES = 1 << 16  # more photons than these share lanes
NEAR = 1e-5  # metres by which a ray begins in front of what was hit


@dataclass(frozen=True, eq=False)
class Photons:
    """What the benchmark reads of a solution: attributes of `radiosity.Solution`; errors are NaN without replicates."""

    irradiance: np.ndarray
    irradiance_standard_error: np.ndarray
    rays: int
    error: float
    surface_power: np.ndarray
    few: np.ndarray


_rooms: dict[int, "_Room"] = {}


def photons(patches: rd.Patches, lines: int, seed: int, replicates: int = 1) -> Photons:
    """Trace about as many lines, all replicates together; the room is prepared once."""
    if id(patches) not in _rooms:
        _rooms[id(patches)] = _Room(patches)
    room = _rooms[id(patches)]
    runs = [room.solve(lines // replicates, seed * replicates + number) for number in range(replicates)]
    values = np.stack([irradiance for irradiance, _ in runs])
    mean, error = values.mean(axis=0), np.full_like(values[0], np.nan)
    if replicates > 1:
        error = values.std(axis=0, ddof=1) / np.sqrt(replicates)
    received = np.stack([np.bincount(patches.surface, patches.area * value[:, 0])[:, None] for value in values])
    reflected = np.stack(
        [np.bincount(patches.surface, (patches.area * patches.reflectance.T * value.T)[0])[:, None] for value in values]
    )
    stated = float(np.sqrt(squares(patches.reflectance, patches.area, mean + error, mean).max()))
    return Photons(
        mean, error, sum(count for _, count in runs), stated, np.stack([received, reflected]), np.zeros(len(patches), bool)
    )


class _Room:
    """A Mitsuba scene of two triangles a patch, and tables of patches on the device."""

    def __init__(self, patches: rd.Patches):
        """Each face is one patch, a parallelogram; one rectangle of them is the lamp, and is black."""
        if len(patches.scene.bands) > 1 or not patches.scene.is_quad.all() or (patches.columns * patches.rows > 1).any():
            raise rd.MethodError("the photon loop takes grey rooms whose faces are one patch each")
        import mitsuba as mi

        mi.set_variant("llvm_ad_rgb")
        self.mi, self.patches = mi, patches
        corners, count = patches.corners, len(patches)
        first = 4 * np.arange(count)[:, None]
        mesh = mi.Mesh("room", 4 * count, 2 * count)
        parameters = mi.traverse(mesh)
        parameters["vertex_positions"] = mi.Float(corners.astype(np.float32).ravel())
        parameters["faces"] = mi.UInt32((first + np.array([[0, 1, 2, 0, 2, 3]])).astype(np.uint32).ravel())
        parameters.update()
        self.scene = mi.load_dict({"type": "scene", "mesh": mesh})
        table = np.concatenate([patches.normal, patches.reflectance], axis=1)
        self.table = mi.Float(table.astype(np.float32).ravel())
        lit = patches.emission[:, 0] > 0
        self.power = float(patches.area[lit] @ patches.emission[lit, 0])
        self.normal = patches.normal[lit][0].tolist()
        low, high = corners[lit].reshape(-1, 3).min(axis=0), corners[lit].reshape(-1, 3).max(axis=0)
        self.low, self.size = low.tolist(), (high - low).tolist()
        if not np.isclose(np.sort(high - low)[1:].prod(), patches.area[lit].sum()):
            raise rd.MethodError("the photon loop takes rooms whose lamp is one rectangle along two axes")
        bound = (patches.area @ patches.reflectance[:, 0]) / patches.area.sum()
        self.path = 1 / (1 - bound)  # lines of a photon, about

    def solve(self, lines: int, seed: int) -> tuple[np.ndarray, int]:
        """Irradiance, (n_patches, 1), and lines, when each lane has had its share of the photons."""
        import drjit as dr

        mi = self.mi
        count = max(int(lines / self.path), 1)
        lanes = min(LANES, count)
        share = -(-count // lanes)
        counters = dr.zeros(mi.UInt32, len(self.patches))
        state, sequence = mi.sample_tea_32(dr.arange(mi.UInt32, lanes), mi.UInt32(seed))
        random = mi.PCG32(initstate=mi.UInt64(state), initseq=mi.UInt64(sequence))
        origin, direction = self._emit(random)
        left = dr.full(mi.UInt32, share - 1, lanes)
        dr.while_loop(
            (random, mi.Point3f(origin), mi.Vector3f(direction), left, dr.full(mi.Bool, True, lanes)),
            lambda random, origin, direction, left, going: going,
            lambda *state: self._bounce(counters, *state),
            mode="symbolic",
        )
        hits = np.array(counters)
        irradiance = self.power / (lanes * share) * hits / self.patches.area
        return irradiance[:, None], int(hits.sum())

    def _bounce(self, counters, random, origin, direction, left, going):
        """One line of each photon, and the next photon where it is absorbed."""
        import drjit as dr

        mi = self.mi
        ray = mi.Ray3f(origin, direction)
        hit = self.scene.ray_intersect_preliminary(ray, coherent=False, active=going)
        met = going & hit.is_valid()
        patch = hit.prim_index >> 1
        dr.scatter_reduce(dr.ReduceOp.Add, counters, mi.UInt32(1), patch, met, mode=dr.ReduceMode.Auto)
        wall = dr.gather(mi.Vector4f, self.table, patch, met)
        normal = mi.Normal3f(wall.x, wall.y, wall.z)
        on = met & (random.next_float32() < wall.w)
        begun, emitted = self._emit(random)
        origin = dr.select(on, mi.Point3f(ray(hit.t) + normal * NEAR), begun)
        direction = dr.select(on, self._cosine(random, normal), emitted)
        going = on | (going & (left > 0))
        left = dr.select(on, left, left - 1)
        return random, origin, direction, left, going

    def _emit(self, random):
        """Origin and direction of a new photon."""
        mi = self.mi
        place = [random.next_float32() if extent > 0 else 0.0 for extent in self.size]
        origin = [low + extent * u for low, extent, u in zip(self.low, self.size, place, strict=True)]
        normal = mi.Normal3f(*self.normal)
        return mi.Point3f(mi.Point3f(*origin) + normal * NEAR), self._cosine(random, normal)

    def _cosine(self, random, normal):
        mi = self.mi
        local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(random.next_float32(), random.next_float32()))
        return mi.Frame3f(normal).to_world(local)
