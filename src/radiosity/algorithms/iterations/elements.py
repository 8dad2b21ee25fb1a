"""Elements of the patches' hierarchy in kernels: which one holds a patch, what it sends, and how what it received is shared out.

A patch of column c and row r lies, on level l of its side, in the cell c >> m, r >> m, where 2^m patches make a cell's edge
(`patches.hierarchy`). So elements are found by arithmetic, and a step stores one number for each element that is no patch.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...device.recorded import loop
from ...patches.hierarchy import Hierarchy, exponent
from ...tracing.faces import COLUMN_BITS, INVERTED, QUAD
from ...tracing.line_tracer import LineTracer
from ...tracing.ray_generation import BACK, MASK, Frame

EXPONENT, ROW_SHIFT = 31, 5  # of a record's first word: five bits each for the exponents of columns and rows
SHARE = 2.0**44  # fixed point units of Phi in sums over elements


@dataclass(frozen=True)
class Place:
    """The place of patches in the trees of their sides; all UInt32, but ``quad`` and ``back`` Bool.

    Attributes:
        face: the number of the face.
        column, row, inverted: of the patch's cell.
        columns, rows: exponents of two, cells along the edges of the face.
        first: the number of the side's root among all elements that are no patches.
    """

    face: Any
    back: Any
    column: Any
    row: Any
    inverted: Any
    quad: Any
    columns: Any
    rows: Any
    first: Any

    @property
    def deepest(self):
        """The level of the patches."""
        return dr.maximum(self.columns, self.rows)

    def shifts(self, level):
        """Return how often columns and rows are still cut into halves below a level."""
        return tuple(dr.select(count > level, count - level, 0) for count in (self.columns, self.rows))

    def cell(self, level):
        """Return column, row and inverted flag of the element of a level that holds the patch."""
        wide, high = self.shifts(level)
        column, row = self.column >> wide, self.row >> high
        # the centroid of a triangle's cell, in thirds of a cell, within the square that it lies in
        x, y = (3 * (own - (cell << wide)) + 1 + self.inverted for own, cell in ((self.column, column), (self.row, row)))
        return column, row, dr.select(~self.quad & (x + y > 3 << wide), type(column)(1), type(column)(0))

    def element(self, level):
        """Return the number of the element of a level above the patches, among those that are no patches."""
        column, row, inverted = self.cell(level)
        across = 1 << dr.minimum(level, self.columns)
        number = dr.select(self.quad, row * across + column, row * (2 * across - row) + 2 * column + inverted)
        return self.first + _above(level, dr.minimum(self.columns, self.rows)) + number

    def rank(self, level):
        """Return the number of an element of a level among those with its parent, and the exponent of how many these are."""
        column, row, inverted = self.cell(level)
        wide, high = (dr.select(count >= level, type(column)(1), type(column)(0)) for count in (self.columns, self.rows))
        _, _, parent = self.cell(level - 1)
        quad = (column & wide) + ((row & high) << wide)
        corner = (column & 1) + 2 * (row & 1)
        triangle = dr.select(parent == 0, corner + 3 * inverted, dr.select(inverted == 1, corner, 0))
        return dr.select(self.quad, quad, triangle), wide + high


def _above(level, both):
    """Return the number of cells of the levels above a level, as `Hierarchy` does."""
    square = ((1 << 2 * dr.minimum(level, both)) - 1) // 3
    return square + ((1 << both) * ((1 << dr.maximum(level, both)) - (1 << both)))


class Elements:
    """The elements of all replicates, those that are no patches behind the slots of lines.

    Attributes:
        tree: the hierarchy of the patches.
        tracer: of the lines.
        inner: the number of elements of a replicate that are no patches.
        size: the number of slots and of elements that are no patches, of all replicates.
        total: the number of patches of all replicates, on the device.

    Raises:
        SceneError: columns or rows are no powers of two.
    """

    def __init__(self, tracer: LineTracer):
        patches = tracer.geometry.patches
        self.tracer, self.tree, self.types = tracer, Hierarchy(patches), tracer.types
        tree = self.tree
        inner = np.diff(tree.first) - patches.cells_per_face[tree.side_face]
        first = np.cumsum(inner) - inner
        self.inner = int(inner.sum())
        self.size = tracer.slots + self.inner * tracer.replicates
        columns, rows = exponent(patches.columns), exponent(patches.rows)
        record = np.zeros((len(columns), 2), np.uint32)
        record[:, 0] = columns | rows << ROW_SHIFT
        record[tree.side_face[~tree.side_is_back], 1] = first[~tree.side_is_back]
        self._records = upload(self.types.UInt32, record)
        self._inner, self._slots = (dr.opaque(self.types.UInt32, count) for count in (self.inner, tracer.slots))
        self.total = dr.opaque(self.types.UInt32, tracer.total)

    def row(self, number):
        """Return the patches of patch numbers, without their replicates."""
        return number - self.tracer.replicate_or_none(number) * self.tracer.n_opaque

    def place(self, number) -> Place:
        """Return the places of patch numbers."""
        face, cell = self.tracer.record(number)
        back, face = face >= BACK, face & (BACK - 1)
        exponents, first = dr.gather(self.types.Array2u, self._records, face)
        columns, rows = exponents & EXPONENT, exponents >> ROW_SHIFT
        first += dr.select(back, _above(dr.maximum(columns, rows), dr.minimum(columns, rows)), 0)
        inverted, quad = dr.select(cell & INVERTED != 0, self.types.UInt32(1), self.types.UInt32(0)), cell & QUAD != 0
        return Place(face, back, cell & MASK, (cell >> COLUMN_BITS) & MASK, inverted, quad, columns, rows, first)

    def frame(self, place: Place) -> Frame:
        """Return the frame of the face of a place, whose edges are those of patches."""
        side = dr.select(place.back, self.types.UInt32(BACK), self.types.UInt32(0))
        return Frame.read(self.types, self.tracer.geometry.face_records, place.face | side)

    def slot(self, number, place: Place, level):
        """Return the slot of the element of a level that holds a patch number: the patch itself on the deepest level."""
        replicate = self.tracer.replicate_or_none(number)
        above = self._slots + replicate * self._inner + place.element(level)
        return dr.select(level < place.deepest, above, number)

    def pulled(self, sent):
        """Return the power that patches send, and that of all patches of each element, (size,) Float.

        Args:
            sent: (total,) Float64, the size of what each patch number sends, a share of Phi.
        """
        types = self.types
        whole = types.UInt64(dr.ceil(sent * SHARE))
        dr.eval(whole)
        sums = dr.opaque(types.UInt64, 0, self.size)
        number = dr.arange(types.UInt32, self.tracer.total)
        place = self.place(number)

        def body(level):
            dr.scatter_add(sums, whole, self.slot(number, place, level))
            return (level + 1,)

        loop((dr.zeros(types.UInt32, self.tracer.total),), lambda level: level <= place.deepest, body)
        found = types.Float(types.Float64(sums) * (1 / SHARE))
        dr.eval(found)
        return found

    def pushed(self, received, columns: int):
        """Return what patches received, with their shares of what elements received, (slots * columns,) Int64.

        Each element shares out what it has evenly among its children, in whole numbers: those of lower rank take one unit more
        where it does not divide. So no unit is lost or made.

        Args:
            received: (size * columns,) Int64.
        """
        types, width = self.types, self.tracer.slots * columns
        entry = dr.arange(types.UInt32, width)
        slot, column = entry // columns, entry % columns
        is_patch = slot < self.total
        number = dr.select(is_patch, slot, 0)
        place = self.place(number)

        def body(level, held):
            held = held + dr.gather(types.Int64, received, self.slot(number, place, level) * columns + column)
            rank, exponent = place.rank(level + 1)
            rest = held - ((held >> exponent) << exponent)
            return level + 1, (held >> exponent) + dr.select(types.Int64(rank) < rest, types.Int64(1), types.Int64(0))

        begin = (dr.zeros(types.UInt32, width), dr.zeros(types.Int64, width))
        _, held = loop(begin, lambda level, held: is_patch & (level < place.deepest), body)
        pushed = dr.gather(types.Int64, received, entry) + held
        dr.eval(pushed)
        return pushed
