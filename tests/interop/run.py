"""Writes files, reads each with both readers and compares."""

import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import radiosity as rd
from radiosity.errors import RadiosityWarning

from .compare import Difference, Outcome, differences
from .draw import Sample
from .record import Reading, Refused, merged, ours

ReadAll = Callable[[list[Path], Path], "list[Reading | Refused]"]


@dataclass(frozen=True)
class Reader:
    """Another program that reads a format.

    Attributes:
        read: readings of files; the second argument is a folder for its own files.
        whole: it knows no surfaces, only the whole file.
        spared: features whose files it is not given, since it reads past what they hold.
        missing: says why it cannot be used here, or None.
        called: what it calls a surface of ours.
        hidden: names of surfaces begin so that it does not tell of.
        more: other differences of a file, our scene and features.
    """

    read: ReadAll
    whole: bool = False
    spared: frozenset[str] = frozenset()
    missing: Callable[[], str | None] = lambda: None
    called: Callable[[str], str] = str
    hidden: tuple[str, ...] = ()
    more: Callable[[Path, rd.Scene, set[str]], list[Difference]] = lambda path, scene, features: []


def each(read: Callable[[Path], Reading]) -> ReadAll:
    """A reader of one file as a reader of many."""

    def read_all(paths: list[Path], folder: Path):
        found = []
        for path in paths:
            try:
                found.append(read(path))
            except Refused as error:
                found.append(error)
        return found

    return read_all


def run(folder: Path, write: Callable[[Path, int], Sample], seeds: Iterable[int], name: str, reader: Reader) -> Outcome:
    """Compare our reader with another one."""
    samples = [sample for seed in seeds if not (sample := write(folder, seed)).features & reader.spared]
    outcome = Outcome()
    for sample, theirs in zip(samples, reader.read([sample.path for sample in samples], folder), strict=True):
        scene = load(sample.path)
        mine = {key: one for key, one in ours(scene).items() if not key.startswith(reader.hidden)}
        if isinstance(theirs, Refused) or not theirs:
            found = [Difference("*", "refused", "faces", [str(theirs) if theirs else "nothing is read, and nothing is said"])]
        elif reader.whole:
            found = differences(merged(mine), merged(theirs))
        else:
            found = differences({reader.called(key): one for key, one in mine.items()}, theirs)
        outcome.add(sample, name, found + reader.more(sample.path, scene, sample.features))
    return outcome


def load(path: Path) -> rd.Scene:
    """What our reader gives. It may warn of what it takes differently; the comparison shows what that is."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RadiosityWarning)
        return rd.load_scene(path)
