"""The result of a radiative exchange: net heat and temperatures of surfaces, with errors."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..errors import MethodError
from ..patches.model import Patches
from ..solution.intervals import student
from .report import SURROUNDINGS, report


@dataclass(frozen=True, eq=False)
class RadiativeExchange:
    """Net heat and temperatures of surfaces. `radiosity.radiative_exchange` makes it.

    Net heat is what a surface gives off to the others by radiation, less what it takes from them. It is positive where the
    surface heats the others: a heater must supply it. It is negative where the surface must be cooled. That of all surfaces and
    the surroundings together is zero.

    Attributes:
        names: names of the surfaces.
        conditions: of each surface "temperature", "flux" or "adiabatic", whatever was given; "none" where it has no patch.
        area: (n,) m² that radiate.
        emissivity: (n, n_bands) area mean.
        net, net_standard_error: (n,) W; the error is NaN where it is unknown (a single replicate).
        temperature, temperature_standard_error: (n,) K; of floating surfaces the fourth root of the area mean of T^4.
        surroundings: K, or None.
        surroundings_net, surroundings_net_standard_error: W that the surroundings give off.
        exchange, exchange_standard_error: (n + 1, n + 1) W that go straight from one surface to another, less what comes back.
            The last row and column are the surroundings. Rows sum to net heat.
        wavelengths: edges between bands, µm.
        patch_net, patch_net_standard_error: (n_patches,) W/m².
        patch_temperature: (n_patches,) K; NaN where a patch exchanges nothing.
        patches: the patches.
        rays, replicates, seed: lines in all, and what made them.
        quanta: lines of each replicate, by which `trace_lines` makes the same again.
        seconds: of tracing and solving.
        status: "complete", "not reached" (the error asked for) or "interrupted".
        provenance: what made the result.

    Example:
        >>> maze = rd.subdivide(rd.load_scene("labyrinth"), cells=1)
        >>> heat = rd.radiative_exchange(maze, {"floor": 310, "*": 290}, emissivity=0.9, rays=100_000)
        >>> heat["floor"]["condition"], bool(heat["floor"]["net low"] < heat["floor"]["net"])
        ('temperature', True)
    """

    names: tuple[str, ...]
    conditions: tuple[str, ...]
    area: np.ndarray
    emissivity: np.ndarray
    net: np.ndarray
    net_standard_error: np.ndarray
    temperature: np.ndarray
    temperature_standard_error: np.ndarray
    surroundings: float | None
    surroundings_net: float
    surroundings_net_standard_error: float
    exchange: np.ndarray
    exchange_standard_error: np.ndarray
    wavelengths: tuple[float, ...]
    patch_net: np.ndarray
    patch_net_standard_error: np.ndarray
    patch_temperature: np.ndarray
    patches: Patches
    rays: int
    replicates: int
    seed: int
    quanta: int
    seconds: float
    status: str = "complete"
    provenance: dict = field(default_factory=dict)

    def net_interval(self, level: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
        """Return the interval that holds the net heat with a probability of ``level``, (n,) W each; NaN where unknown."""
        half = student(level, self.replicates) * self.net_standard_error
        return self.net - half, self.net + half

    def temperature_interval(self, level: float = 0.95) -> tuple[np.ndarray, np.ndarray]:
        """Return the interval that holds the temperature with a probability of ``level``, (n,) K each; NaN where unknown."""
        half = student(level, self.replicates) * self.temperature_standard_error
        given = np.array([condition == "temperature" for condition in self.conditions])
        half = np.where(given, 0.0, half)
        return np.maximum(self.temperature - half, 0), self.temperature + half

    def __getitem__(self, name: str) -> dict:
        """Return the row of a surface, see `table`."""
        for row in self.table():
            if row["surface"] == name:
                return row
        raise MethodError(f"no surface is called '{name}'; there are {', '.join(self.names[:20])}")

    def table(self, level: float = 0.95) -> list[dict]:
        """Return a row for each surface, and one for the surroundings where there are some.

        Keys are surface, condition, area (m²), emissivity (a number, or one a band), temperature, its error, low and high (K),
        net (W given off), its error, low and high, and flux (net heat over area, W/m²).
        """
        (low, high), (cold, hot) = self.net_interval(level), self.temperature_interval(level)
        rows = []
        for i, name in enumerate(self.names):
            if not self.area[i] > 0:
                continue  # no patch has this name
            bands = self.emissivity[i].tolist()
            rows.append(
                {
                    "surface": name,
                    "condition": self.conditions[i],
                    "area": float(self.area[i]),
                    "emissivity": bands[0] if len(bands) == 1 else bands,
                    "temperature": float(self.temperature[i]),
                    "temperature error": float(self.temperature_standard_error[i]),
                    "temperature low": float(cold[i]),
                    "temperature high": float(hot[i]),
                    "net": float(self.net[i]),
                    "net error": float(self.net_standard_error[i]),
                    "net low": float(low[i]),
                    "net high": float(high[i]),
                    "flux": float(self.net[i] / self.area[i]),
                }
            )
        if self.surroundings is not None:
            half = student(level, self.replicates) * self.surroundings_net_standard_error
            watts, kelvin = float(self.surroundings_net), float(self.surroundings)
            rows.append(
                {
                    "surface": SURROUNDINGS,
                    "condition": "temperature",
                    "area": float("nan"),
                    "emissivity": 1.0,
                    **dict.fromkeys(("temperature", "temperature low", "temperature high"), kelvin),
                    "temperature error": 0.0,
                    "net": watts,
                    "net error": float(self.surroundings_net_standard_error),
                    "net low": watts - half,
                    "net high": watts + half,
                    "flux": float("nan"),
                }
            )
        return rows

    def report(self) -> str:
        """Return a table in text."""
        return report(self)

    def __str__(self) -> str:
        return self.report()

    def save(self, path) -> Path:
        """Write an .npz file for `radiosity.load_exchange`. Patches and scene are in it.

        Raises:
            OutputError: the file cannot be written.
        """
        from .saving import save

        return save(self, Path(path))

    def export(self, path) -> Path:
        """Write a file: .npz (`save`), .csv (the table, and beside it NAME.exchange.csv), .png (three pictures).

        Raises:
            OutputError: the format is unknown, or the file cannot be written.
        """
        from .files import export

        return export(self, Path(path))
