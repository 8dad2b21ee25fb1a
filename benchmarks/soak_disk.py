"""A small disk for ``soak.py``, which is full for spells: a file system of its own where root may mount one."""

import os
import subprocess
import threading
import time
from pathlib import Path

import numpy as np

SIZE = "4m"
FREE, FULL = (20.0, 120.0), (15.0, 60.0)  # seconds that it is free and full, drawn between these two


class Disk:
    """A folder on a disk of its own, and a thread that fills it from time to time; a context.

    Attributes:
        folder: of the disk; an ordinary folder where none may be mounted.
        spells: when it was full, in seconds of the clock; the last may go on (infinity).
        mounted: False where no disk of its own could be had, and there are no spells.
    """

    def __init__(self, folder: Path, seed: int):
        self.folder, self.spells, self.mounted = folder, [], False
        self._random, self._over = np.random.Generator(np.random.Philox(seed)), threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def __enter__(self) -> "Disk":
        self.folder.mkdir(parents=True, exist_ok=True)
        command = ["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "tmpfs", str(self.folder)]
        self.mounted = subprocess.run(command, capture_output=True).returncode == 0
        if self.mounted:
            self._thread.start()
        return self

    def __exit__(self, *_) -> None:
        if self.mounted:
            self._over.set()
            self._thread.join()
            subprocess.run(["umount", str(self.folder)], check=True)

    def full(self, begin: float, end: float) -> float:
        """The seconds between two times of the clock in which it was full."""
        return sum(max(0.0, min(end, last) - max(begin, first)) for first, last in list(self.spells))

    def _run(self) -> None:
        filler = self.folder / "filler"
        while not self._over.wait(self._random.uniform(*FREE)):
            with filler.open("wb", buffering=0) as file:
                try:
                    while file.write(os.urandom(1 << 16)):
                        pass
                except OSError:  # it is full
                    pass
            self.spells.append((time.time(), float("inf")))
            self._over.wait(self._random.uniform(*FULL))
            filler.unlink()
            self.spells[-1] = (self.spells[-1][0], time.time())
