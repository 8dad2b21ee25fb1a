"""The older name of `radiosity.check`; new code calls that."""

from ..diagnostics.check import check

__all__ = ["check"]
