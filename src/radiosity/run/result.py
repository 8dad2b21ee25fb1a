"""The results of runs: what a run needs of a result to go on from it."""

from typing import Protocol, TypeVar


class Result(Protocol):
    """The parts that a `Solution` and every other result of a run have; their meaning is that of `Solution`."""

    @property
    def quanta(self) -> int: ...

    @property
    def seconds(self) -> float: ...

    @property
    def status(self) -> str: ...

    @property
    def provenance(self) -> dict: ...

    @property
    def state(self) -> dict: ...


R = TypeVar("R", bound=Result)
