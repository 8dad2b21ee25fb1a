"""Hooks: functions of upper folders that lower folders call, by name.

A folder imports only folders below its own. Where a class of a lower folder has a method that needs an upper folder, the method
calls a hook. `radiosity/__init__.py`, which is above all folders, fills the table before anything else of the package runs. The
functions import their folder when they are called.
"""

from collections.abc import Callable
from typing import Any

HOOKS: dict[str, Callable[..., Any]] = {}
