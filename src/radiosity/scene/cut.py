"""The record of a cut scene: which face of the whole scene each of its faces is a part of."""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True, eq=False)
class Cut:
    """The faces of a scene are parts of the faces of another one, the whole scene. Light does not depend on it.

    Attributes:
        whole: `Scene.hash` of the whole scene.
        face: (n_faces,) int64, the face of the whole scene that each face is a part of.
        region: (n_faces,) int64, a number that parts share which no contact line holds apart.
    """

    whole: str
    face: np.ndarray
    region: np.ndarray

    def take(self, rows: np.ndarray) -> "Cut":
        """Return the record of a choice of faces (indices or mask)."""
        return replace(self, face=self.face[rows], region=self.region[rows])
