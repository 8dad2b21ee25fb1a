"""Processes of ``make bench-error`` and ``make bench-heat``: one a scene and method, with the package of this checkout or of a
commit.
"""

import json
import os
import subprocess
import sys
import tarfile
import tempfile
from io import BytesIO
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORKER = Path(__file__).with_name("error_worker.py")

_sources: dict[str, tempfile.TemporaryDirectory] = {}


class Refused(Exception):
    """The method or the scene cannot be had; the text says why."""


class Process:
    """A worker that has not ended; ``with`` ends it."""

    def __init__(self, scene: str, method: str, worker: Path = WORKER, python: str = sys.executable):
        """``method`` may end in ``@COMMIT``; ``python`` is the interpreter that runs ``worker``."""
        self.name, _, commit = method.partition("@")
        environment = os.environ | {"PYTHONPATH": str(_source(commit) if commit else ROOT / "src")}
        self._process = subprocess.Popen(
            [python, worker, scene, self.name],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )

    def ask(self, do: str, **what) -> dict:
        """Have something done by a method of `error_worker.Worker`.

        Raises:
            Refused: with the reason.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        try:
            print(json.dumps({"do": do, **what}), file=self._process.stdin, flush=True)
            answer = self._process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer:
            raise Refused(f"its process ended with {self._process.wait()}")
        told = json.loads(answer)
        if "refused" in told:
            raise Refused(told["refused"])
        return told

    def __enter__(self) -> "Process":
        return self

    def __exit__(self, *_) -> None:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


def _source(commit: str) -> Path:
    """The package of a commit, unpacked once into a temporary folder."""
    if commit not in _sources:
        archive = subprocess.run(["git", "archive", commit, "src"], cwd=ROOT, capture_output=True)
        if archive.returncode:
            raise Refused(f"git has no commit {commit} here: {archive.stderr.decode(errors='replace').strip()}")
        folder = tempfile.TemporaryDirectory(prefix="radiosity-")
        with tarfile.open(fileobj=BytesIO(archive.stdout)) as opened:
            opened.extractall(folder.name, filter="data")
        _sources[commit] = folder
    return Path(_sources[commit].name) / "src"
