"""What the page gets: a mesh for each surface, in the colours of a look."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from ..errors import OutputError
from . import glb, tone_mapping
from .frame import Frame
from .look import Look
from .mesh import Shapes, Triangles
from .refinement import MOST, refined
from .shades import Colours
from .subject import Subject

MOST_NODES = 128  # surfaces with a mesh of their own, the largest ones; smaller ones share one, since each costs a draw call
LIFT = 2e-3  # of a patch's size, by which its edges lie in front of it
EDGE = 0.35  # linear grey of edges
MOST_EDGED = 300_000  # patches whose edges can be drawn: more of them could not be told apart


@dataclass(frozen=True, eq=False)
class Content:
    """A subject in the page's coordinates."""

    shapes: Shapes
    frame: Frame

    @staticmethod
    def of(subject: Subject) -> "Content":
        """Return the content of a subject."""
        return Content(Shapes(subject), Frame.of(subject.patches.scene))

    def at(self, subject: Subject) -> "Content":
        """Return the content of another solution; meshes are kept where the patches are the same."""
        return replace(self, shapes=self.shapes.at(subject))

    @property
    def subject(self) -> Subject:
        """What is shown."""
        return self.shapes.subject

    @cached_property
    def node(self) -> np.ndarray:
        """The mesh that each surface is in, (n_surfaces,)."""
        patches = self.subject.patches
        count = np.bincount(patches.surface, minlength=len(patches.scene.names))
        node = np.full(len(count), MOST_NODES)
        largest = np.argsort(-count, kind="stable")[:MOST_NODES]
        node[largest] = np.arange(len(largest))
        return node

    def colours(self, look: Look) -> Colours:
        """Return the colours of a look.

        Raises:
            OutputError: the quantity or band is not there, or the limits are no range.
        """
        subject = self.subject
        quantity = subject.quantity(name_of(subject, look), look.band, single=look.shades.false)
        return Colours.of(look.shades, quantity, subject.patches.area)

    def meshes(self, look: Look, colours: Colours) -> Iterator[tuple[str, bytes]]:
        """Yield the name of each node, and its GLB."""
        patches, quantity = self.subject.patches, colours.quantity
        whole = self.shapes.triangles(name_of(self.subject, look), quantity, look.band, smooth=look.smooth)
        node = self.node[patches.surface[whole.patch]].copy()
        node[np.isin(patches.surface[whole.patch], list(look.hidden))] = -1
        order = np.argsort(node, kind="stable")
        bounds = np.searchsorted(node[order], np.arange(MOST_NODES + 2))
        for number, (begin, end) in enumerate(pairwise(bounds)):
            if begin == end:
                continue
            part = whole.take(order[begin:end])
            part = part if look.cut is None else part.cut(look.cut)
            part = refined(part, colours.linear) if look.smooth and len(whole.corners) <= MOST else part
            if len(part.corners):
                yield f"/surfaces/{number}", self._glb(part, colours)

    def edges(self, look: Look) -> bytes | None:
        """Return the edges of the patches that are shown, as a GLB of lines; None where there are none.

        Raises:
            OutputError: there are too many of them.
        """
        patches = self.subject.patches
        shown = np.flatnonzero(~np.isin(patches.surface, list(look.hidden)))
        if len(shown) > MOST_EDGED:
            raise OutputError(f"{len(shown):,} patches have too many edges to see; hide surfaces until {MOST_EDGED:,} are left")
        corners = patches.corners[shown]
        if look.cut is not None:  # a patch that the plane cuts shows no edges
            kept = (look.cut.beyond(corners) <= 0).all(axis=1)
            shown, corners = shown[kept], corners[kept]
        if not len(shown):
            return None
        corners = corners + (LIFT * np.sqrt(patches.area[shown])[:, None] * patches.normal[shown])[:, None, :]
        first = np.arange(len(shown))[:, None] * 4
        lines = np.stack([first + np.arange(4), first + np.roll(np.arange(4), -1)], axis=2)
        lines = lines[np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2) > 0]
        grey = np.full((corners.shape[0] * 4, 3), EDGE)
        return glb.document(self.frame.to_page(corners.reshape(-1, 3)), tone_mapping.before(grey), lines)

    def _glb(self, part: Triangles, colours: Colours) -> bytes:
        through = self.subject.patches.scene.transmittance
        opacity = 1.0 if through is None else 1.0 - float(self.subject.patches.transmittance[part.patch].mean())
        given = tone_mapping.before(colours.linear(part.values))
        return glb.document(self.frame.to_page(part.vertices), given, part.corners, opacity=opacity)


def name_of(subject: Subject, look: Look) -> str:
    """Return the name of the quantity that a look shows."""
    return next(iter(subject.names)) if look.quantity is None else look.quantity
