"""PDF files, printed by a Chromium or Chrome that is installed.

The same page gives the same bytes by the same browser: the time is taken out, and marks of elements, which differ from one run of
the browser to the next, are counted anew.
"""

import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from ..errors import OutputError
from ..solution.whole import whole_file

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge")
PLACES = ("/Applications/Google Chrome.app/Contents/MacOS/Google Chrome", "/Applications/Chromium.app/Contents/MacOS/Chromium")
LIMIT = 180  # seconds
MARKS = re.compile(rb"\(node\d{8}\)")
DATES = re.compile(rb"/(CreationDate|ModDate) \(D:[^)]*\)")


def browser(path) -> str:
    """Return the program that prints.

    Raises:
        OutputError: none is installed.
    """
    found = next((place for place in map(shutil.which, NAMES) if place), None)
    found = found or next((place for place in PLACES if Path(place).exists()), None)
    if found is None:
        raise OutputError(
            f"{path}: a PDF is printed by Chromium or Chrome, and none is found (looked for {', '.join(NAMES)}); install one, or "
            "write .html and print it in any browser"
        )
    return found


def write(page: str, path: Path) -> None:
    """Print a page as PDF.

    Raises:
        OutputError: no browser is installed, or it fails.
    """
    program = browser(path)
    with tempfile.TemporaryDirectory(prefix="radiosity-", ignore_cleanup_errors=True) as folder:
        source, target = Path(folder) / "page.html", Path(folder) / "page.pdf"
        source.write_text(page, encoding="utf-8")
        command = [program, "--headless", "--disable-gpu", "--no-pdf-header-footer", "--no-first-run", "--disable-extensions"]
        command += ["--disable-dev-shm-usage", f"--user-data-dir={folder}/profile", f"--print-to-pdf={target}"]
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            command.append("--no-sandbox")  # as root Chromium starts in no other way; the page runs nothing
        try:
            done = subprocess.run([*command, source.as_uri()], capture_output=True, timeout=LIMIT, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise OutputError(
                f"{path}: {program} could not print the report ({error}); write .html and print it yourself"
            ) from None
        if not target.exists() or not target.stat().st_size:
            said = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
            raise OutputError(
                f"{path}: {program} printed no PDF (exit status {done.returncode}{': ' + said[0] if said else ''}); write .html "
                "and print it yourself"
            )
        data = target.read_bytes()
    with whole_file(path) as file:
        file.write(repeatable(data))


def repeatable(data: bytes) -> bytes:
    """Return a PDF without what differs from run to run; its length and all offsets stay."""
    marks = {mark: b"(node%08d)" % place for place, mark in enumerate(sorted(set(MARKS.findall(data))))}
    return MARKS.sub(lambda found: marks[found[0]], DATES.sub(_timeless, data))


def _timeless(found: re.Match) -> bytes:
    """Return a fixed date with as many bytes, so that all offsets in the file stay right."""
    inside = len(found[0]) - len(found[1]) - len(b"/ (D:)")
    return b"/" + found[1] + b" (D:" + b"20000101000000"[:inside].ljust(inside, b"0") + b")"
