"""The interface of orders of the firing engine."""

from abc import ABC, abstractmethod

from ...base import Swept
from ..counters import FiringCounters


class AbstractOrder(ABC):
    """Fires lines until none is due. Orders differ in which line is fired when; the counters end as the same integers.

    An order asks which lines are due (`due`, `due_between`), and fires them (`fire`), or follows single lines
    itself and claims each by an atomic counter, as `depth_first.walk` does.
    """

    @abstractmethod
    def run(self, counters: FiringCounters, swept: Swept) -> None:
        """Fire every line that is due.

        ``swept(lines)`` is called where the counters are whole, with the number of lines traced since the last call. An exception
        of it ends the work, and another call of `run` continues.
        """
