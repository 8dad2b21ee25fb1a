"""What the patches of lanes send on of the light that they receive."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...device.backend import upload
from ...patches.scatter import Scatter
from .packets import Packets


@dataclass(frozen=True, eq=False)
class LaneScatter:
    """The `Scatter` of lanes. Lanes without a patch send nothing on.

    Attributes:
        reflectance: of each group of bands, (lanes,) Float.
        through: the same of diffuse transmittance; None where nothing diffuses light.
        beyond: UInt32 (lanes,), the lane of the other side of each; None where nothing diffuses light.
        size: how many functions the basis has: values have so many columns of each group.
    """

    reflectance: list
    through: list | None = None
    beyond: Any = None
    size: int = 1

    @staticmethod
    def of_lanes(packets: Packets, scatter: Scatter, size: int = 1) -> "LaneScatter":
        """Return that of all lanes from that of the patches."""
        if scatter.through is None or scatter.other is None:
            return LaneScatter(_columns(packets, scatter.reflectance), size=size)
        places = packets.place[scatter.other][packets.order] + packets.width * np.arange(packets.replicates)[:, None]
        beyond = upload(packets.types.UInt32, places.ravel().astype(np.uint32))
        return LaneScatter(_columns(packets, scatter.reflectance), _columns(packets, scatter.through), beyond, size)

    @cached_property
    def albedo(self) -> list:
        """The share of received light that is sent on, to both sides together, of each group, (lanes,) Float."""
        if self.through is None:
            return self.reflectance
        found = [rho + tau for rho, tau in zip(self.reflectance, self.through, strict=True)]
        dr.eval(found)
        return found

    def of(self, values: list, group: int | None = None) -> list:
        """Return what received values are sent on as.

        Args:
            values: of each column, (lanes,) Float; or of all columns several times, one after the other.
            group: the values are of this group alone.
        """
        groups = len(self.reflectance)
        which = [index // self.size % groups if group is None else group for index in range(len(values))]
        sent = [self.reflectance[at] * value for at, value in zip(which, values, strict=True)]
        if self.through is None:
            return sent
        dr.eval(values)
        across = [dr.gather(type(value), value, self.beyond) for value in values]
        return [one + self.through[at] * value for one, at, value in zip(sent, which, across, strict=True)]


def _columns(packets: Packets, values: np.ndarray) -> list:
    """Return the value of each group at each lane from (n_patches, n_groups)."""
    _, _, place, patch = packets.read()
    real = place < dr.opaque(packets.types.UInt32, packets.n)
    columns = [upload(packets.types.Float, column.astype(np.float32)) for column in values.T]
    found = [dr.gather(packets.types.Float, column, patch, real) for column in columns]
    dr.eval(found)
    return found
