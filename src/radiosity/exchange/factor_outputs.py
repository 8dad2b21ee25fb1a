"""Output files of view factors, by their suffix."""

from pathlib import Path

from ..errors import OutputError
from ..image.output import each_writable

SUFFIXES = (".csv", ".npz", ".idf")


def check(paths, zone: str | None) -> None:
    """Refuse, before any work, outputs that could not be written after it.

    Args:
        paths: the files.
        zone: the EnergyPlus zone of ``.idf`` files.

    Raises:
        OutputError: an unknown format, a folder that cannot be written to, one file named twice, or no zone.
    """
    for path in each_writable(paths, SUFFIXES):
        if path.suffix.lower() == ".idf" and zone is None:
            raise OutputError(f"{path}: EnergyPlus needs the name of the zone; give --zone NAME")


def write(factors, path, zone: str | None, layout: str) -> None:
    """Write one of the files of `check`."""
    suffix = Path(path).suffix.lower()
    if suffix == ".csv":
        factors.to_csv(path, layout=layout)
    elif suffix == ".npz":
        factors.to_npz(path)
    else:
        factors.to_energyplus(path, zone=zone or "")
