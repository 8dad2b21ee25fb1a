"""What a run's integers mean: irradiance with errors, and the books."""

from dataclasses import dataclass

import numpy as np

from ..patches.model import Patches
from ..solution.books import Books, exact_dot, exact_sum
from ..solution.errors import mean_and_error, relative_error
from .bands import QUANTUM, BandGroups
from .quanta import Source


@dataclass(frozen=True, eq=False)
class Snapshot:
    """A complete stage: the problem, and the integers as `state.capture` names them."""

    patches: Patches
    source: Source
    groups: BandGroups
    state: dict[str, np.ndarray]

    @property
    def quanta(self) -> int:
        return int(self.state["quanta"])

    @property
    def lines(self) -> int:
        return int(self.state["fired"].sum(dtype=np.uint64))

    def irradiance(self) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard error, (n_patches, n_bands) each."""
        columns = [self._irradiance(group) for group in range(self.groups.n_groups)]
        scaled = [[x * s for x in columns[g]] for g, s in zip(self.groups.index, self.groups.scale, strict=True)]
        mean, error = (np.stack(column, axis=1) for column in zip(*scaled, strict=True))
        return mean, error

    def _irradiance(self, group: int) -> tuple[np.ndarray, np.ndarray]:
        counts = self.state["received"][..., group] if "received" in self.state else self.state["arrivals"]
        unit = self.source.power / self.quanta / (QUANTUM if "received" in self.state else 1)
        mean, error = mean_and_error(counts)
        return mean * (unit / self.patches.area), error * (unit / self.patches.area)

    def error(self) -> float:
        """See `Solution.error`."""
        irradiance, error = self.irradiance()
        rho = self.patches.reflectance
        return relative_error(rho * irradiance, rho * error, self.patches.area, (irradiance, error))

    def books(self) -> tuple[dict, ...]:
        """See `Solution.books`."""
        books = [self._books(group) for group in range(self.groups.n_groups)]
        result = []
        for group, scale in zip(self.groups.index, self.groups.scale, strict=True):
            book = books[group]
            powers = {name: getattr(book, name) * book.watts * scale for name in Books.COLUMNS}
            result.append(powers | {"closes": book.closes})
        return tuple(result)

    def _books(self, group: int) -> Books:
        state, source = self.state, self.source
        replicates = len(state["arrivals"])
        rho = Source.fixed(self.groups.reflectance[:, group])
        if "received" not in state:
            counts, missed, fired, unit = state["arrivals"], state["missed"], exact_sum(state["fired"]), 1
            whole, fraction = source.emitted(self.quanta)
            emitted = ((exact_sum(whole) << 32) + exact_sum(fraction)) * replicates
        else:
            counts, missed, unit = state["received"][..., group], state["received_missed"][..., group], QUANTUM
            fired = exact_sum(state["fired_power"][group])
            share = self.groups.emission[:, group] * self.patches.area / source.power
            emitted = round(float(share.sum()) * self.quanta * QUANTUM) * replicates << 32
        reflected = sum(exact_dot(row, rho) for row in counts)
        arrived = exact_sum(counts) << 32
        watts = source.power / self.quanta / unit / 2**32 / replicates
        return Books(
            emitted, fired << 32, reflected, arrived - reflected, exact_sum(missed[0]) << 32, exact_sum(missed[1]) << 32, watts
        )
