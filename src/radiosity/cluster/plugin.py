"""The plugin that brings a job to workers: to those that are there, and to each that comes later, before its first task."""

from typing import Any

from distributed import WorkerPlugin

from . import post, worker


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
