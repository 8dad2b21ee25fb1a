"""Scenes on workers: each is sent once, for all measurements and pieces of final gathers of a connection."""

from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

from ..device.backend import choose
from ..problem.model import Problem
from ..tracing.geometry import Geometry
from .gpus import tell_of_shared
from .job import AbstractJob


@dataclass(frozen=True, eq=False)
class SceneJob(AbstractJob):
    """A scene on workers.

    Attributes:
        problem: the scene, and the numbers that the driver has computed from it.
        device: the name of the device that the run is of.
    """

    problem: Problem
    device: str

    @cached_property
    def geometry(self) -> Geometry:
        """The scene on the device of this process."""
        return Geometry(self.problem.patches, choose(self.device))


_sent: WeakKeyDictionary[Any, list[SceneJob]] = WeakKeyDictionary()  # by client


def scene_on(client: Any, problem: Problem, device: str) -> SceneJob:
    """Return the scene that the workers of a client have, and bring it to them where they do not have it."""
    from .plugin import bring

    there = _sent.setdefault(client, [])
    found = next((scene for scene in there if scene.problem is problem and scene.device == device), None)
    if found is None:
        tell_of_shared(client, device)
        found = SceneJob(problem, device)
        bring(client, found)
        there.append(found)
    return found


def forget_scenes(client: Any) -> None:
    """Take all scenes off the workers of a client."""
    for scene in _sent.pop(client, []):
        with suppress(Exception):  # the scheduler may have gone
            if client.status == "running":
                client.unregister_worker_plugin(f"radiosity-{scene.key}")
