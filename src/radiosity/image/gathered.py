"""What lines of sight see with a final gather: the light at the very point of the surface, not the value of its patch."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import OutputError
from ..hooks import HOOKS
from ..patches.at_points import values_at
from .lookup import Lookup
from .quantity import OF_DIRECTIONS, in_columns

SHOWN = ("radiosity", "irradiance", *OF_DIRECTIONS)
LEAST = 4  # lines of a sample: less tell nothing of lamps and surfaces
MOST = 1 << 24  # lines of a pixel


def lines_of(final_gather, samples: int, *, name: str = "final_gather", of: str = "a pixel", parts: str = "samples") -> float:
    """Return the lines of each sample of a pixel.

    Args:
        final_gather: lines of a pixel.
        samples: of a pixel.
        name, of, parts: words for the message, where it is not a pixel.

    Raises:
        OutputError: it is no whole number, or makes no sense.
    """
    try:
        good = not isinstance(final_gather, bool) and int(final_gather) == final_gather
    except (TypeError, ValueError, OverflowError):
        good = False
    if not good or not LEAST * samples <= final_gather <= MOST:
        raise OutputError(
            f"{name} is {final_gather!r}; it must be a whole number of lines {of}, from {LEAST * samples} "
            f"({LEAST} for each of {samples} {parts}) to {MOST}"
        )
    return final_gather / samples


@dataclass(frozen=True, eq=False)
class Gathered:
    """The lookup of values at points.

    Attributes:
        lookup: finds patches.
        gather: finds the light that falls on points of them, see `radiosity.sensors.pixels.Gather`.
        quantity: one of `SHOWN`.
        band, single: columns, see `radiosity.image.quantity.choose`.
    """

    lookup: Lookup
    gather: Any
    quantity: str
    band: str | int | None = None
    single: bool = False

    @staticmethod
    def of(solution, lookup: Lookup, quantity: str, band, *, single: bool, lines: float, points: int, **options) -> "Gathered":
        """Prepare the gather of a picture.

        Args:
            lines: of each point.
            points: how many there are at most.
            options: seed, progress and cluster (a client).

        Raises:
            OutputError: the quantity is not one of light.
        """
        if quantity not in SHOWN:
            raise OutputError(f"a final gather finds {', '.join(SHOWN)}, not '{quantity}'; leave it out")
        return Gathered(lookup, HOOKS["gather"](solution, lines, points, **options), quantity, band, single)

    @property
    def columns(self) -> int:
        """The number of values of a point."""
        return self.lookup.columns

    def __call__(self, hits) -> tuple[np.ndarray, np.ndarray]:
        """Return values, (m, n), and patches, (m,), see `Lookup`."""
        patch = self.lookup.patch(hits)
        seen = np.flatnonzero(patch >= 0)
        values = np.zeros((len(patch), self.columns))
        values[seen] = self.values(patch[seen], np.asarray(hits.u, np.float64)[seen], np.asarray(hits.v, np.float64)[seen])
        return values, patch

    def _add_from_beyond(self, found: np.ndarray, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> None:
        """Add what comes through diffusing panes from their other sides."""
        patches = self.lookup.patches
        if patches.diffuse_transmittance is None:
            return
        through = patches.diffuse_transmittance[patch]
        lit = np.flatnonzero(through.any(axis=1))
        found[lit] += through[lit] * self.gather.irradiance(patches.other_side[patch[lit]], u[lit], v[lit])

    def values(self, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return values at points of patches, (m, n).

        Args:
            patch: (m,) on whose side each lies.
            u, v: (m,) face coordinates.
        """
        return self.with_backs(patch, u, v)[0]

    def with_backs(self, patch: np.ndarray, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return values at points, as `values` does, and the share of each point's lines that met absorbing backs, (m,).

        It is 0 at black points, which need no lines where what surfaces send is shown.
        """
        patches = self.lookup.patches
        if self.quantity == "irradiance":
            found, behind = self.gather.with_backs(patch, u, v)
        else:
            reflectance = values_at(patches, "reflectance", patch, u, v)
            found, behind = values_at(patches, "emission", patch, u, v), np.zeros(len(patch))
            lit = np.flatnonzero(reflectance.any(axis=1))  # black points need no gather
            light, behind[lit] = self.gather.with_backs(patch[lit], u[lit], v[lit])
            found[lit] += reflectance[lit] * light
            self._add_from_beyond(found, patch, u, v)
            found /= np.pi if self.quantity in OF_DIRECTIONS else 1.0
        return in_columns(self.gather.solution, found, self.band, single=self.single), behind
