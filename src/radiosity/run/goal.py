"""The goal of a run: the error asked for, whether it is reached, and whether it can be."""

import math
from dataclasses import dataclass

from ..patches import Patches
from ..scene.habits import warn
from .error_target import Target, nothing_before_lights
from .snapshot import Snapshot

DARK = 1e7  # lines without any light on any patch: no error is looked for any longer


@dataclass(frozen=True, eq=False)
class Goal:
    """An error that is to be reached, if any.

    Attributes:
        patches: of the run.
        wanted: the relative error; None where none is asked for.
        target: whose error it is.
    """

    patches: Patches
    wanted: float | None
    target: Target

    def margin(self, snapshot: Snapshot) -> float:
        """Return how many times the stated error the true one may be; NaN with too few hits, 1 where no error is asked for."""
        if self.wanted is None:
            return 1.0
        return self.target.margin(snapshot) if self.target.judged(snapshot) else math.nan

    def reached(self, snapshot: Snapshot, bound: float) -> bool:
        """Return whether the error was reached, or is as small as it gets.

        Args:
            bound: the true error is below this in 95 % of runs; NaN where that is not known.
        """
        return snapshot.done or self.dark(snapshot) or bound <= (self.wanted or 0)

    def dark(self, snapshot: Snapshot) -> bool:
        """Return whether an error is asked for, but no patch can receive anything, or none did in very many lines."""
        nothing = self.wanted is not None and not snapshot.irradiance[0].any()
        return nothing and (snapshot.lines >= DARK or nothing_before_lights(self.patches))

    def warn_of_dark(self, snapshot: Snapshot) -> None:
        """Warn where no patch received anything in very many lines."""
        if self.dark(snapshot) and snapshot.lines >= DARK:
            warn(
                f"{self.patches.scene.source}: no light reached any patch in {snapshot.lines:,.0f} lines, so that there "
                "is no error to reach; do lamps face the scene, and does a window let the sky in?"
            )
