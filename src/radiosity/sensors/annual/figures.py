"""The figures of annual daylight: shares of occupied hours in which sensors get enough light, or too much.

- Daylight autonomy (DA): C. F. Reinhart, O. Walkenhorst, "Validation of dynamic RADIANCE-based daylight simulations for a test
  office with external blinds", Energy and Buildings 33(7), 2001, 683-697. Continuous DA counts an hour below the threshold in
  part: Z. Rogers, "Daylighting metric development using daylight autonomy calculations in the sensor placement optimization
  tool", Architectural Energy Corporation, 2006.
- Useful daylight illuminance (UDI), 100 lx, 300 lx and 3000 lx: J. Mardaljevic, M. Andersen, N. Roy, J. Christoffersen,
  "Daylighting metrics: is there a relation between useful daylight illuminance and daylight glare probability?", Building
  Simulation and Optimization, 2012. (A. Nabil and J. Mardaljevic had 100, 500 and 2000 lx in 2005.)
- Spatial daylight autonomy (sDA 300 lx, 50 %) and annual sunlight exposure (ASE 1000 lx, 250 h), of 8 to 18 o'clock: IES
  LM-83-12.
"""

from dataclasses import dataclass

import numpy as np

ENOUGH, HALF = 300.0, 0.5  # lx, and the share of occupied hours, of sDA
BINS = (100.0, 300.0, 3000.0)  # lx, of UDI
SUNNY, MOST_HOURS = 1000.0, 250.0  # lx by the sun alone, and hours, of ASE
OF_HOURS = ("DA", "cDA", "UDI below", "UDI supplementary", "UDI autonomous", "UDI above")  # shares of occupied hours
FIGURES = (*OF_HOURS, "sun hours", "mean")


@dataclass(eq=False)
class Figures:
    """Sums over the hours so far.

    Attributes:
        sums: (..., n_sensors, n_figures) float64.
        occupied: the number of occupied hours so far.
    """

    sums: np.ndarray
    occupied: float = 0.0

    @staticmethod
    def nothing(*shape: int) -> "Figures":
        """Return those of no hour, of values of a shape."""
        return Figures(np.zeros((*shape, len(FIGURES))))

    def add(self, lux: np.ndarray, by_sun: np.ndarray, occupied: np.ndarray) -> None:
        """Add hours.

        Args:
            lux: (..., n_sensors, n_hours), of all daylight.
            by_sun: of the sun alone, without reflections.
            occupied: (n_hours,) bool.
        """
        lux, by_sun = lux[..., occupied], by_sun[..., occupied]
        low, middle, high = BINS
        columns = (
            lux >= ENOUGH,
            np.minimum(lux / ENOUGH, 1.0),
            lux < low,
            (lux >= low) & (lux < middle),
            (lux >= middle) & (lux <= high),
            lux > high,
            by_sun >= SUNNY,
            lux,
        )
        for place, column in enumerate(columns):
            self.sums[..., place] += column.sum(axis=-1)
        self.occupied += int(occupied.sum())

    def values(self) -> dict[str, np.ndarray]:
        """Return the figures by name, (..., n_sensors) each: shares of occupied hours; hours of sun; and the mean in lx."""
        whole = max(self.occupied, 1.0)
        return {name: self.sums[..., place] / (1.0 if name == "sun hours" else whole) for place, name in enumerate(FIGURES)}

    def dark(self, hours: int) -> None:
        """Add occupied hours without light."""
        self.sums[..., FIGURES.index("UDI below")] += hours
        self.occupied += hours


def of_set(values: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the figures of a set of sensors, (...) each, from those of its sensors, (..., n_sensors) each."""
    means = {name: values[name].mean(axis=-1) for name in (*OF_HOURS, "mean")}
    return means | {
        "sDA": (values["DA"] >= HALF).mean(axis=-1),
        "ASE": (values["sun hours"] > MOST_HOURS).mean(axis=-1),
    }
