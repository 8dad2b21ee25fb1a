"""A headless browser for tests of pages; they are left out where there is none."""

import io
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

import numpy as np
import pytest

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-angle=swiftshader",  # OpenGL in software
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
SIZE = {"width": 900, "height": 700}
PATIENCE = 120  # seconds that a page may take, on a machine that has other work

missing = next((name for name in ("viser", "playwright", "matplotlib") if find_spec(name) is None), None)
needed = pytest.mark.skipif(
    missing is not None or CHROMIUM is None, reason=f"{missing or 'Chromium'} is not installed, which shows pages"
)


@contextmanager
def browser() -> Iterator:
    """Start a browser with settings of its own; yield its context."""
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as settings, sync_playwright() as play:
        context = play.chromium.launch_persistent_context(
            settings, executable_path=CHROMIUM, headless=True, viewport=SIZE, args=ARGUMENTS, accept_downloads=True
        )
        context.set_default_timeout(1000 * PATIENCE)
        try:
            yield context
        finally:
            context.close()


def pixels(page) -> np.ndarray:
    """Return what a page shows, (height, width, 3) int."""
    return pixels_of(page.screenshot())


def pixels_of(png: bytes) -> np.ndarray:
    """Return the pixels of a PNG file, (height, width, 3) int."""
    from PIL import Image

    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)
