"""What a format cannot hold: it is collected while a file is written, and told once a kind."""

from collections.abc import Iterable
from dataclasses import dataclass, field

from ..errors import shown
from ..scene.habits import warn


@dataclass(eq=False)
class Told:
    """Names by what becomes of them."""

    names: dict[str, dict[str, None]] = field(default_factory=dict)

    def add(self, what: str, names: Iterable[str]) -> None:
        """Note that something happens to what is called so; ``what`` is a clause such as "sensors are left out"."""
        for name in names:
            self.names.setdefault(what, {})[name] = None

    def report(self, path) -> None:
        """Warn once a kind."""
        for what, names in self.names.items():
            warn(f"{path}: {what}: {shown(names)}")
