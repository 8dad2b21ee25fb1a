"""What patches send on of the light that they receive: what they reflect, and what a diffusing pane lets through."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True, eq=False)
class Scatter:
    """The operator of the equation B = E + rho H + tau H', where H' is the irradiance of the other side of each patch.

    Attributes:
        reflectance: (n_patches, k) float64, rho; k bands or groups of bands.
        through: (n_patches, k) float64, tau, equal on both sides of a patch; None where nothing diffuses light.
        other: (n_patches,) int64, the patch on the other side, see `Patches.other_side`; None where nothing diffuses light.
    """

    reflectance: np.ndarray
    through: np.ndarray | None = None
    other: np.ndarray | None = None

    @cached_property
    def albedo(self) -> np.ndarray:
        """The share of received light that is sent on, to both sides together, (n_patches, k). The rest is absorbed."""
        return self.reflectance if self.through is None else self.reflectance + self.through

    def column(self, group: int) -> "Scatter":
        """Return that of one group: its arrays, and values that it takes, are (n_patches,)."""
        return Scatter(self.reflectance[:, group], None if self.through is None else self.through[:, group], self.other)

    @property
    def in_column(self) -> "Scatter":
        """Return that of a single group from its `column`, for `of_rows`."""
        return Scatter(self.reflectance[:, None], None if self.through is None else self.through[:, None], self.other)

    def of_moments(self, moments: np.ndarray) -> np.ndarray:
        """Return what (n_patches, k, m) received moments are sent on as."""
        sent = self.reflectance[:, :, None] * moments
        return sent if self.through is None else sent + self.through[:, :, None] * moments[self.other]

    def of(self, values: np.ndarray) -> np.ndarray:
        """Return what (n_patches, k) received values are sent on as."""
        sent = self.reflectance * values
        return sent if self.through is None else sent + self.through * values[self.other]

    def of_rows(self, values: np.ndarray, group: int) -> np.ndarray:
        """Return what (..., n_patches) received values of one group are sent on as."""
        sent = values * self.reflectance[:, group]
        return sent if self.through is None else sent + values[..., self.other] * self.through[:, group]

    def error_of(
        self, errors: np.ndarray, beyond: np.ndarray | None = None, rows: np.ndarray | slice = slice(None)
    ) -> np.ndarray:
        """Return errors of what is sent on from errors of what is received, (n_patches, k).

        Errors of both sides are of the same lines: their sum is never too small.

        Args:
            errors: of all patches, or of some.
            beyond: those of the other side of each. Default: ``errors`` are of all patches, and hold them.
            rows: which patches.
        """
        reflectance = self.reflectance[rows]
        error = np.where(reflectance == 0, 0.0, reflectance * errors)
        if self.through is None:
            return error
        through = self.through[rows]
        return error + np.where(through == 0, 0.0, through * (errors[self.other] if beyond is None else beyond))
