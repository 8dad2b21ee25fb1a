"""What an order of the firing engine is."""

from abc import ABC, abstractmethod

from ...base import Swept
from ..counters import FiringCounters


class AbstractOrder(ABC):
    """Fires until no row owes a line. Orders differ in which line is fired when; the counters end as the same integers.

    An order asks `FiringCounters` what is due (`due`, `due_between`), and has it fired (`fire`), or follows single lines itself,
    claiming each by an atomic counter as `depth_first.walk` does.
    """

    @abstractmethod
    def run(self, counters: FiringCounters, swept: Swept) -> None:
        """Fire every line owed. ``swept(lines)`` is called where the counters are whole, with the lines traced since; what it
        raises ends the work, and another call goes on."""
