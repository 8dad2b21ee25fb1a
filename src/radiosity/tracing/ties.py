"""Ties: which of several faces in one plane a line meets.

Where faces lie within 4 ulps of each other (`scene.coplanar`), the BVH gives any one of them. Here a line meets first a face
whose radiating side it comes to, then one whose back absorbs, then a pane, and last one that lets it pass. Of several it meets
the smallest, which lies on the others; of equal ones the first in the scene's order. Each face is tried with the line itself.
So what is met is a function of the line and the faces, not of the packet in which the line was traced, nor of how faces are cut.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import upload
from ..device.recorded import loop
from ..scene.coplanar import contacts, copied
from ..scene.model import Back, Scene
from ..scene.precision import EPSILON
from .faces import Faces

WORDS = 16  # of a face's record: origin, edges, normal in units of hit records, largest coordinate
KIND_BIT = 28  # of a rank: the face that a line meets first has the lowest rank
NONE = 0xFFFFFFFF
QUAD = 1 << 28  # of a face's flags, as in `geometry`
FEW = 2  # faces in a cell, about: a face is cut into cells, each with the faces that reach it
EACH_CELLS = (8, 4, 2, 1)  # least number along each edge of a face on which others lie: the first that needs, in all, at most
AT_LEAST_ALL = 1 << 18  # cells
MOST_CELLS = 256  # along each edge
ALIKE = 1e-5  # areas that differ by less are equal
BESIDE = 1 / 64  # of a cell and of a face's edge: faces reach this much further into others' cells
CERTAIN = 4 * EPSILON  # of the line's length: a line this little beside a face meets it
LEAST = 64  # entries of a table


@dataclass(frozen=True, eq=False)
class Ties:
    """Faces of a scene that share a plane with others, for kernels."""

    table: Faces

    @cached_property
    def copied(self) -> np.ndarray:
        """The face that stands for each face, (n_faces,) int64, see `scene.coplanar`."""
        return copied(self.table.scene)

    @cached_property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """Pairs of faces that stand for themselves and lie in one plane."""
        every = contacts(self.table.scene)
        rows = every.coplanar & (self.copied[every.one] == every.one) & (self.copied[every.two] == every.two)
        return every.one[rows], every.two[rows]

    @cached_property
    def standing(self) -> np.ndarray:
        """Faces that stand for themselves or for copies, and lie on others, (k,) int64."""
        copies = np.flatnonzero(self.copied != np.arange(self.table.scene.n_faces))
        return np.unique(np.concatenate([*self.pairs, self.copied[copies]]))

    @cached_property
    def behind(self) -> np.ndarray:
        """The copy of each face that a line from behind meets first; the face itself where it has none: (n_faces,) int64."""
        order = np.argsort(_kinds(self.table.scene), kind="stable")
        best = np.arange(len(order))
        copies, first = np.unique(self.copied[order], return_index=True)
        best[copies] = order[first]
        return best

    @cached_property
    def faces(self) -> np.ndarray:
        """Faces that lines may meet where several lie in one plane, (m,) int64; of faces of one kind, lines meet the first."""
        faces = np.unique(np.concatenate([self.standing, self.behind[self.standing]]))
        return faces[np.argsort(np.round(np.log(self.table.scene.area[faces]) / ALIKE), kind="stable")]

    @cached_property
    def flagged(self) -> np.ndarray:
        """Which faces lie on others, (n_faces,) bool."""
        return np.isin(self.copied, self.standing)

    def prepare(self) -> None:
        """Make what kernels read."""
        _ = self.tables

    @cached_property
    def tables(self) -> tuple[Any, Any, Any, Any, Any]:
        """Five tables on the device: cells of faces, where cells' entries begin, ranks of faces in cells, records, words.

        A face's entry says where its cells begin and how many there are along an edge. A rank has a record and four words:
        first patch, flags, the BVH's first triangle, and 1 for a pane, else 0.
        """
        table = self.table
        types, scene, patches = table.device.types, table.scene, table.patches
        along, begins, entries = self._cells()
        cells = np.zeros((scene.n_faces, 2), np.uint32)
        cells[self.standing] = np.column_stack([np.cumsum(along**2) - along**2, along])
        cells = cells[self.copied]
        origin, one, two = (part[self.faces] for part in table.frames)
        normal = table.steps[self.faces]
        record = np.zeros((len(self.faces), WORDS))
        record[:, :12] = np.concatenate([origin, one, two, normal], axis=1)
        words = np.zeros((len(self.faces), 4), np.uint32)
        words[:, 0], words[:, 1] = patches.first[:-1][self.faces], table.packed[self.faces]
        words[:, 2], words[:, 3] = table.first_primitives[self.faces], scene.panes[self.faces]
        UInt32, padded = types.UInt32, lambda a: np.concatenate([a.ravel(), np.zeros(LEAST, a.dtype)])
        return (
            upload(UInt32, padded(cells)),
            upload(UInt32, padded(begins.astype(np.uint32))),
            upload(UInt32, padded(entries.astype(np.uint32))),
            upload(types.Float, padded(record.astype(np.float32))),
            upload(UInt32, padded(words)),
        )

    def _cells(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return cells along an edge of standing faces; (sum of squares + 1,) where each cell's entries begin; ranks of faces."""
        one, two = self.pairs
        at = np.searchsorted(self.standing, np.concatenate([one, two, self.standing]))
        other = np.concatenate([two, one, self.standing])
        more = np.flatnonzero(self.behind[other] != other)
        at, other = np.concatenate([at, at[more]]), np.concatenate([other, self.behind[other[more]]])
        many = np.bincount(at)
        least = np.where(many > 1, next(n for n in EACH_CELLS if n == 1 or n * n * len(many) <= AT_LEAST_ALL), 1)
        along = np.maximum(least, np.ceil(np.sqrt(many / FEW))).clip(1, MOST_CELLS).astype(np.int64)
        low, high = self._places(at, other)
        n = along[at][:, None]
        margin = BESIDE * (1 + 1 / n)
        begin = np.clip(np.floor((low - margin) * n), 0, n - 1).astype(np.int64)
        end = np.clip(np.floor((high + margin) * n), 0, n - 1).astype(np.int64) + 1
        wide, deep = (end - begin).T
        row = np.repeat(np.arange(len(at)), wide * deep)
        step = np.arange(len(row)) - np.repeat(np.cumsum(wide * deep) - wide * deep, wide * deep)
        x, y = begin[row, 0] + step % wide[row], begin[row, 1] + step // wide[row]
        first = np.cumsum(along**2) - along**2
        cell = first[at[row]] + y * along[at[row]] + x
        rank = np.zeros(self.table.scene.n_faces, np.int64)
        rank[self.faces] = np.arange(len(self.faces))
        entries = rank[other[row]]
        order = np.lexsort([entries, cell])
        counts = np.bincount(cell, minlength=int((along**2).sum()))
        return along, np.concatenate([[0], np.cumsum(counts)]), entries[order]

    def _places(self, at: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the box of other faces in the coordinates of standing ones: two corners, (m, 2) each."""
        origin, first, second = (part[self.standing[at]] for part in self.table.frames)
        corners = self.table.corners[other] - origin[:, None]
        aa, ab, bb = (np.einsum("mi,mi->m", p, q) for p, q in ((first, first), (first, second), (second, second)))
        pa, pb = (np.einsum("mki,mi->mk", corners, edge) for edge in (first, second))
        area = (aa * bb - ab * ab)[:, None]
        uv = np.stack([bb[:, None] * pa - ab[:, None] * pb, aa[:, None] * pb - ab[:, None] * pa], axis=2) / area[..., None]
        return uv.min(axis=1), uv.max(axis=1)

    def meet(self, hit, flagged, origin, direction, *, beyond: bool = False) -> list[tuple]:
        """Return what lines meet where the first hit is a face that shares its plane; called in a kernel.

        Args:
            hit: a `hits.Hit`; the faces that are ``flagged`` share a plane.
            beyond: also return what a line that came from the other side would meet there.

        Returns:
            For one or two sides: whether a face was found, the fields of its hit, and its normal, as in `hits._hit`.
        """
        types = self.table.device.types
        UInt32 = types.UInt32
        cells, begins, entries, *_ = self.tables
        face = dr.gather(UInt32, self.table.primitive_faces, hit.primitive, flagged)
        first, along = dr.gather(types.Array2u, cells, face, flagged)
        x, y = (UInt32(dr.clip(c, 0, 1) * types.Float(along)) for c in (hit.u, hit.v))
        cell = first + dr.minimum(y, along - 1) * along + dr.minimum(x, along - 1)
        at, end = dr.gather(UInt32, begins, cell, flagged), dr.gather(UInt32, begins, cell + 1, flagged)
        nobody = dr.full(UInt32, NONE, dr.width(at))
        count, some_panes = 1 + beyond, bool(self.table.scene.panes.any())

        def body(at, *best):
            going = at < end
            rank = dr.gather(UInt32, entries, at, going)
            inside, front, packed, *_, pane = self._tried(rank, origin, direction, going)
            kind = packed >> 30
            behind = dr.select(kind == int(Back.RADIATES), UInt32(0), dr.select(kind == int(Back.ABSORBS), UInt32(1), UInt32(2)))
            before = dr.select(kind == int(Back.OPEN), UInt32(2), UInt32(0))
            shown = [dr.select(front, before, behind), dr.select(front, behind, before)][:count]
            if some_panes:
                shown = [dr.select(side == 2, UInt32(3), dr.select(pane == 1, UInt32(2), side)) for side in shown]
            found = [rank | (side << KIND_BIT) for side in shown]
            best = [dr.select(going & inside, dr.minimum(old, new), old) for old, new in zip(best, found, strict=True)]
            return at + 1, *best

        state = (at, *(UInt32(nobody) for _ in range(count)))
        _, *best = loop(state, lambda at, *best: at < end, body)
        return [self._met(key, side == 1, origin, direction, flagged) for side, key in enumerate(best)]

    def _met(self, key, turned: bool, origin, direction, flagged) -> tuple:
        found = flagged & (key != NONE)
        rank = key & ((1 << KIND_BIT) - 1)
        _, front, packed, first, primitive, u, v, distance, normal, _ = self._tried(rank, origin, direction, found)
        return found, (found, primitive, u, v, ~front if turned else front, distance, first, packed), normal

    def _tried(self, rank, origin, direction, active) -> tuple:
        """Intersect lines with the planes of faces (T. Möller, B. Trumbore, JGT 2(1), 1997).

        Returns:
            Whether the line goes through the face, whether from the front; the face's words, coordinates, distance, normal; and
            1 for a pane.
        """
        types = self.table.device.types
        *_, records, words = self.tables
        block = dr.gather(types.Array44f, records, rank, active)
        parts = [block[i // 4][i % 4] for i in range(WORDS)]
        corner, one, two, normal = (types.Array3f(*parts[at : at + 3]) for at in range(0, 12, 3))
        first, packed, primitive, pane = dr.gather(types.Array4u, words, rank, active)
        away, across = origin - corner, dr.cross(direction, two)
        turned, area = dr.cross(away, one), dr.dot(one, across)
        scale = 1 / area
        u, v, distance = dr.dot(away, across) * scale, dr.dot(direction, turned) * scale, dr.dot(two, turned) * scale
        size = (dr.norm(away) + dr.norm(one) + dr.norm(two)) * dr.abs(scale) * CERTAIN
        beside_u, beside_v = size * dr.norm(two), size * dr.norm(one)
        quad = (packed & QUAD) != 0
        inside = (u >= -beside_u) & (v >= -beside_v)
        inside &= dr.select(quad, (u <= 1 + beside_u) & (v <= 1 + beside_v), u + v <= 1 + beside_u + beside_v)
        return inside, dr.dot(direction, normal) < 0, packed, first, primitive, u, v, distance, normal, pane


def _kinds(scene: Scene) -> np.ndarray:
    """Return the rank of backs, lowest first: those that radiate, that absorb, those of panes, those that let lines pass."""
    back = scene.back
    passes = (back == Back.PASSES) | (back == Back.OPEN)
    return np.select([passes, scene.panes, back == Back.RADIATES], [3, 2, 0], 1)
