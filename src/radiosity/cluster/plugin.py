"""The plugin that brings a job to workers: to those that are there, and to each that comes later, before its first task."""

import time
from typing import Any

from distributed import WorkerPlugin

from ..errors import DeviceError
from . import post, worker

TRIES = 3  # workers may die one after the other while a job is brought to all
PAUSE = 1.0  # seconds between two tries, in which the scheduler forgets the one that died


class JobPlugin(WorkerPlugin):
    """Keeps a job on a worker until it is taken off, and opens the worker for the messages of others."""

    def __init__(self, job: Any):
        self.job, self.name = job, f"radiosity-{job.key}"

    def setup(self, worker: Any) -> None:
        put(self.job)
        post.open_for(worker)

    def teardown(self, worker: Any) -> None:
        drop(self.job.key)


put, drop = worker.put, worker.drop


def bring(client: Any, job: Any) -> None:
    """Bring a job to all workers of a client, those to come among them; once more where a worker dies meanwhile.

    Raises:
        DeviceError: that happens again and again, while the scheduler answers.
    """
    for left in reversed(range(TRIES)):
        try:
            client.register_plugin(JobPlugin(job))
            return
        except OSError as error:  # Dask gives up for all workers where one has gone
            if client.status != "running":
                return  # whoever looks for workers next finds that the scheduler is lost
            if not left:
                raise DeviceError(f"the workers cannot be reached ({error}); their logs say why") from None
            time.sleep(PAUSE)
