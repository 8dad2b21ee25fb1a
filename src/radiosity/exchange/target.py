"""The error that an exchange must reach: of the net heat or the temperature of a surface, or of the largest net heat."""

from dataclasses import dataclass

import numpy as np

from ..errors import MethodError, shown
from ..scene.named import surfaces_called
from ..solution.errors import SURE
from ..solution.intervals import FEW, student
from .estimate import Estimate

NET, TEMPERATURE = KINDS = ("net:", "temperature:")


@dataclass(frozen=True)
class Target:
    """An error to reach.

    Attributes:
        error: relative.
        kind: "net:" or "temperature:".
        surfaces: numbers of the surfaces; each of them must reach it.
        whole: the error is relative to the largest net heat of all, not to each one's own.
    """

    error: float
    kind: str
    surfaces: tuple[int, ...]
    whole: bool = False

    @staticmethod
    def of(names: tuple[str, ...], floats: np.ndarray, error, error_of: str | None) -> "Target":
        """Make the target from arguments.

        Raises:
            MethodError: the error is out of range, the text has another form, there is no such surface, or its value is given.
        """
        try:
            good = not isinstance(error, (bool, str)) and 0 < float(error) < 1
        except (TypeError, ValueError):
            good = False
        if not good:
            raise MethodError(f"error is {error!r}; it must be above 0 and below 1, such as 0.01")
        if error_of is None:
            given = tuple(int(i) for i in np.flatnonzero(~floats))
            return Target(float(error), NET, given, True)
        kind = next((kind for kind in KINDS if str(error_of).startswith(kind)), None)
        wanted = str(error_of).removeprefix(kind or "")
        if kind is None or not wanted:
            raise MethodError(f"error_of is '{error_of}'; write {NET}NAME or {TEMPERATURE}NAME, such as {NET}{names[0]}")
        found = surfaces_called(names, wanted)
        exact = [names[i] for i in found if floats[i] == (kind == NET)]
        if exact:
            what, other = ("net heat", TEMPERATURE) if kind == NET else ("temperature", NET)
            raise MethodError(f"error_of: the {what} of {shown(exact)} is given, and has no error; take {other}NAME")
        return Target(float(error), kind, tuple(found))

    def reached(self, found: Estimate, replicates: int) -> float:
        """Return the relative error that the true one is below in 95 % of runs, the largest of the surfaces; NaN where unknown.

        It is unknown where fewer than 30 lines join a surface to others.
        """
        rows = list(self.surfaces)
        if not rows:
            rows = [len(found.net) - 1]  # all surfaces float: the surroundings
        value, error = (found.net, found.net_error) if self.kind == NET else (found.temperature, found.temperature_error)
        if (found.lines[rows] < FEW).any():
            return float("nan")
        size = np.abs(value[rows])
        size = np.full(len(rows), size.max()) if self.whole else size
        ratio = np.divide(error[rows], size, out=np.where(error[rows] == 0, 0.0, np.inf), where=size > 0)
        return float(student(SURE, replicates) * ratio.max())
