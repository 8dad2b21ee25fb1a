"""What a report is asked to hold."""

from dataclasses import dataclass
from pathlib import Path

from ..scene.camera import Camera


@dataclass(frozen=True)
class Wishes:
    """The wishes of whom asks for a report; `radiosity.write_report` explains them."""

    title: str | None = None
    project: str = ""
    client: str = ""
    author: str = ""
    date: str = ""
    remarks: str = ""
    cameras: tuple[Camera | int, ...] = ()
    width: int = 900
    final_gather: int | None = None
    seed: int = 0
    plans: tuple[str, ...] = ()
    measured: tuple[Path, ...] = ()
    sensors: bool = True
    check: bool = True
    rows: int = 60
