"""Contacts: pairs of faces that lie on each other, or nearly so, and what happens to light between them."""

from dataclasses import dataclass, fields

import numpy as np

from .model import Back, Scene

CERTAIN = 1  # ulps: less is no gap, but what coordinates were rounded by


@dataclass(frozen=True, eq=False)
class Contacts:
    """Pairs of faces, nearer than 8 ulps wherever they overlap. The first of several copies stands for all of them.

    Attributes:
        one, two: (m,) int64, ``one`` before ``two``, pairs in order.
        gap: (m,) float64 metres by which ``two`` lies in front of ``one`` (negative: behind it), where that is most.
        ulp: (m,) float64 metres, an ulp of single precision there.
        share: (m,) float64, the share of the smaller face's area that the two have in common.
        coplanar: (m,) bool, True where they lie in one plane: within 4 ulps.
        same_way: (m,) bool, True where fronts look the same way.
    """

    one: np.ndarray
    two: np.ndarray
    gap: np.ndarray
    ulp: np.ndarray
    share: np.ndarray
    coplanar: np.ndarray
    same_way: np.ndarray

    def take(self, rows: np.ndarray) -> "Contacts":
        """Return some of the pairs (indices or mask)."""
        return Contacts(*(getattr(self, field.name)[rows] for field in fields(Contacts)))

    def doubled(self, scene: Scene) -> np.ndarray:
        """True where both faces lie in one plane and radiate to the same side, so that lines hit only one of them, (m,) bool."""
        radiates = scene.back == Back.RADIATES
        hides = scene.back != Back.OPEN
        return self.coplanar & (self.same_way | radiates[self.one] | radiates[self.two]) & hides[self.one] & hides[self.two]

    def unseen(self, scene: Scene) -> np.ndarray:
        """True where lines from one face begin beyond the other, (m,) bool.

        The face radiates towards the other, which is apart from it, but nearer than the points where lines begin.
        """
        back, turned = scene.back, np.where(self.same_way, -1, 1)
        sides = []
        for face, other, height in ((self.one, self.two, self.gap), (self.two, self.one, turned * self.gap)):
            sees = (height > 0) | (back[face] == Back.RADIATES)
            shows_front = turned * height > 0
            sides.append(sees & (shows_front | (back[other] != Back.PASSES)) & (back[other] != Back.OPEN))
        return (np.abs(self.gap) > CERTAIN * self.ulp) & (sides[0] | sides[1]) & ~self.doubled(scene)

    @staticmethod
    def joined(parts: "list[Contacts]") -> "Contacts":
        """Return the pairs of several contacts, in order, each once."""
        if not parts:
            return Contacts(*(np.zeros(0, t) for t in (np.int64, np.int64, float, float, float, bool, bool)))
        every = Contacts(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Contacts)))
        _, first = np.unique(np.column_stack([every.one, every.two]), axis=0, return_index=True)
        return every.take(first)
