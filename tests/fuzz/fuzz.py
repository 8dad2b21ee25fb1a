"""Read many damaged files of every format in processes that may crash, hang or take too much; keep those that do.

    python tests/fuzz/fuzz.py --formats mgf,npz --first 0 --count 1000 --keep out/fuzz

Any outcome but a scene that makes sense or an error of `radiosity.errors` is told with the file's number, and the file is
kept. File k of a format is always the same, so ``--first k --count 1`` runs it again.
"""

import argparse
import os
import selectors
import subprocess
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
from seeds import FORMATS, damaged  # noqa: E402

SECONDS = 10  # for one file
START = 60  # for the libraries to be there
MEGABYTES = 1024


@dataclass
class Outcome:
    """What became of the files of a format.

    Attributes:
        counts: number of files by what became of them.
        found: number of a file and what is wrong with how it was read.
        nets: numbers of the files that only the last net caught, or that ran out of memory.
    """

    counts: Counter = field(default_factory=Counter)
    found: dict[int, str] = field(default_factory=dict)
    nets: list[tuple[int, str]] = field(default_factory=list)
    seconds: float = 0.0


def fuzz(name: str, first: int, count: int, *, megabytes: int = MEGABYTES) -> Outcome:
    """Read damaged files ``first`` to ``first + count`` of a format; a process that ends is started again after its file."""
    outcome, start, last = Outcome(), time.monotonic(), first + count
    while first < last:
        first = _batch(name, first, last, megabytes, outcome)
    outcome.seconds = time.monotonic() - start
    return outcome


def _batch(name: str, first: int, last: int, megabytes: int, outcome: Outcome) -> int:
    """Run one process; the number to go on from."""
    command = [sys.executable, str(HERE / "worker.py"), name, str(first), str(last), str(megabytes)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stderr is not None
    at, done, late, errors = first - 1, False, False, b""
    with selectors.DefaultSelector() as waiting:
        waiting.register(process.stdout, selectors.EVENT_READ)
        waiting.register(process.stderr, selectors.EVENT_READ)
        rest = b""
        while waiting.get_map():
            ready = waiting.select(SECONDS if at >= first else START)
            if not ready:
                late = True
                process.kill()
                break
            for key, _ in ready:
                data = os.read(key.fd, 1 << 16)
                if not data:
                    waiting.unregister(key.fileobj)
                elif key.fileobj is process.stderr:
                    errors = (errors + data)[-2000:]
                else:
                    *lines, rest = (rest + data).split(b"\n")
                    for line in lines:
                        at, done = _heard(line.decode(), at, outcome)
    status = process.wait()
    process.stdout.close()
    process.stderr.close()
    if done:
        return last
    at = max(at, first)
    said = errors.decode(errors="replace").strip().splitlines()[-1:]
    outcome.found[at] = f"no answer in {SECONDS} s" if late else f"the process ended with status {status} {said}"
    outcome.counts["hang" if late else f"status {status}"] += 1
    return at + 1


def _heard(line: str, at: int, outcome: Outcome) -> tuple[int, bool]:
    """The number of the file at hand, and whether all are done."""
    what, number, *rest = line.split(" ", 2)
    text = "".join(rest)
    if what == "found":
        outcome.found[int(number)] = text
        outcome.counts["found"] += 1
    elif what == "got":
        outcome.counts[text] += 1
        if text.endswith(("net", "memory")):
            outcome.nets.append((int(number), text))
    return (int(number), False) if what == "at" else (at, what == "done")


def keep(name: str, number: int, folder: Path) -> Path:
    """Write a damaged file, and those that it needs, for a look at it."""
    place = folder / f"{name}-{number}"
    place.mkdir(parents=True, exist_ok=True)
    for file, data in damaged(name, number).items():
        (place / file).write_bytes(data)
    return place


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--formats", default=",".join(FORMATS), help=f"some of {','.join(FORMATS)}")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=1000, help="files of each format")
    parser.add_argument("--keep", type=Path, default=Path("out/fuzz"), help="where files go that were read wrongly")
    arguments = parser.parse_args()
    wrong = 0
    for name in arguments.formats.split(","):
        outcome = fuzz(name, arguments.first, arguments.count)
        print(
            f"{name}: {arguments.count} files from {arguments.first} in {outcome.seconds:.1f} s, {dict(outcome.counts)}",
            flush=True,
        )
        for number, text in sorted(outcome.found.items())[:50]:
            print(f"  {text} -> {keep(name, number, arguments.keep)}")
        for number, text in outcome.nets[:5]:
            print(f"  ({text}) -> {keep(name, number, arguments.keep)}")
        wrong += len(outcome.found)
    print(f"{wrong} files were read wrongly")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
