"""Small plausible mistakes, each with the tests that have to notice it (`run.py`)."""

from typing import NamedTuple


class Mistake(NamedTuple):
    """``old`` stands exactly once in ``file``, below src/radiosity, and becomes ``new``; ``tests`` are files of tests/."""

    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    why: str


MISTAKES = (
    # ---- that the tests did not notice once, each the reason for a test
    Mistake("engine/matrix/tally.py", 'if self._last[0] is not state["keys"]:', "if self._last[0] is None:",
            ("test_stages.py",), "the first stage's factors are kept for all stages"),
    Mistake("engine/budget.py", "return quanta >= first and quanta & (quanta - 1) == 0", "return quanta & (quanta - 1) == 0",
            ("test_stages.py",), "powers of two below the first rung are taken for rungs"),
)  # fmt: skip
