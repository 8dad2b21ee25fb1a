"""Files that an interrupted study goes on from: names that tell what they depend on, and parts of the report that are done."""

import hashlib
import json
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

from ..solution.whole import whole_file
from .study import Protocol


def digest(facts: list, protocol: Protocol) -> str:
    """Return 16 letters that differ where facts, the protocol, or versions of the program differ."""
    versions = {package: version(package) for package in ("radiosity", "drjit", "mitsuba")}
    text = json.dumps([*facts, vars(protocol), versions], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def parts(number: int, make: Callable[[Protocol, Path], list[str]], protocol: Protocol, folder: Path) -> list[str]:
    """Return the parts of a report that an experiment makes by itself; made once, as long as its figures are there.

    Args:
        make: writes figures into a folder and returns HTML.
    """
    path = folder / "series" / f"parts-{number}-{digest([], protocol)}.json"
    if path.exists():
        kept = json.loads(path.read_text(encoding="utf-8"))
        if all((folder / name).exists() for name in kept["figures"]):
            return kept["html"]
    made = make(protocol, folder)
    figures = sorted(file.name for file in folder.glob(f"experiment-{number}*.[ps][nv]g"))
    with whole_file(path) as file:
        file.write(json.dumps({"figures": figures, "html": made}).encode())
    return made
