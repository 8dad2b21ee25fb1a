"""Panes of glass, whose transmittance depends on the angle: tables on a device, for kernels.

The solid part of such a pane stops the share 1 - T(cos) of the light from each direction. So its own lines leave it with the
density (1 - T) cos / (1 - t), t being the mean of T over diffuse light, and what it receives and sends stays reciprocal.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from ..device.backend import Device, upload
from ..scene.clear_glass import of_mean, share_at
from ..scene.model import Scene

COSINES = 512  # steps of the table of T
TURNS = 1024  # steps of the table of directions
FINE = 1 << 14  # steps of sums from which that is made


@dataclass(frozen=True, eq=False)
class Angles:
    """Tables of panes, a kind for each pair of transmittance and index.

    Attributes:
        device: where they are.
        kind: UInt32 (n_faces,), the number of each face's kind, from 1; 0: it has one transmittance for all angles.
        through: Float, T at cosine i / `COSINES` of kind k at (k - 1) (`COSINES` + 1) + i.
        turned: Float, the squared sine of what the number i / `TURNS` becomes.
        solid: Float (kinds + 1,), 1 - t of each kind; 1 for 0.
    """

    device: Device
    kind: Any
    through: Any
    turned: Any
    solid: Any

    @staticmethod
    def of(scene: Scene, device: Device) -> "Angles | None":
        """Return the tables of a scene; None where no pane has an index of refraction."""
        if scene.refractive_index is None or scene.transmittance is None:
            return None
        pairs = np.stack([scene.transmittance, scene.refractive_index], axis=1)
        some = scene.refractive_index > 0
        kinds, number = np.unique(pairs[some], axis=0, return_inverse=True)
        kind = np.zeros(scene.n_faces, np.uint32)
        kind[some] = number.ravel() + 1
        through, turned = [], []
        for share, index in kinds:
            transmissivity = of_mean(float(share), float(index))
            cosine = np.arange(1, COSINES + 1) / COSINES
            through.append(np.append(0.0, share_at(cosine, transmissivity, float(index))))
            squares = np.linspace(0, 1, FINE + 1)  # of the sine
            middle = np.sqrt(1 - (squares[1:] + squares[:-1]) / 2)
            stopped = np.append(0.0, np.cumsum(1 - share_at(middle, transmissivity, float(index))))
            turned.append(np.interp(np.arange(TURNS + 1) / TURNS, stopped / stopped[-1], squares))
        Float = device.types.Float
        columns = (np.concatenate(through), np.concatenate(turned), np.append(1.0, 1 - kinds[:, 0]))
        return Angles(device, upload(device.types.UInt32, kind), *(upload(Float, x.astype(np.float32)) for x in columns))

    def share(self, face, cosine, active: Any = True):
        """Return which faces have a table, and the share of light that goes through at this cosine; called in a kernel."""
        kind = dr.gather(self.device.types.UInt32, self.kind, face, active)
        return kind > 0, self._read(self.through, COSINES, kind, cosine)

    def stopped(self, face, cosine):
        """Return how much more of the light from one direction a pane stops than of diffuse light; 1 for other faces.

        It is called in a kernel.
        """
        kind = dr.gather(self.device.types.UInt32, self.kind, face)
        solid = dr.gather(self.device.types.Float, self.solid, kind)
        return dr.select(kind > 0, (1 - self._read(self.through, COSINES, kind, cosine)) / solid, 1)

    def direction(self, face, number):
        """Return the squared sine of a line's angle to the face's normal from a number in [0, 1); called in a kernel."""
        kind = dr.gather(self.device.types.UInt32, self.kind, face)
        return dr.select(kind > 0, dr.minimum(self._read(self.turned, TURNS, kind, number), 1 - 2.0**-24), number)

    def _read(self, table, steps: int, kind, value):
        """Return a table's value between its steps; 0 for kind 0."""
        Float, UInt32 = self.device.types.Float, self.device.types.UInt32
        x = dr.clip(value, 0, 1) * float(steps)
        step = dr.minimum(UInt32(x), steps - 1)
        at, some = (kind - 1) * (steps + 1) + step, kind > 0
        low, high = dr.gather(Float, table, at, some), dr.gather(Float, table, at + 1, some)
        return dr.lerp(low, high, x - Float(step))
