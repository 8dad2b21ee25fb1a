"""The client of a cluster, for what solves and traces on the same one."""

from contextlib import AbstractContextManager, nullcontext
from typing import Any

from ..hooks import HOOKS


def on_cluster(cluster: Any) -> AbstractContextManager:
    """Return a context that gives the client of a cluster, None where there is none; see `solve`."""
    return nullcontext() if cluster is None else HOOKS["connected"](cluster)
