"""``radiosity solve --live`` in a real browser: the page follows, clicks work, and closing the browser stops nothing."""

import re
import subprocess
import sys

import numpy as np
import pytest
from browsers import browser, needed, pixels

import radiosity as rd

pytestmark = [needed, pytest.mark.slow]
RUN = ["solve", "room", "--cells", "4", "--method", "random-walk", "--seed", "3"]
LINES = 40_000_000  # a run that goes on for some seconds after the browser is closed


def test_a_browser_that_is_closed_stops_nothing(tmp_path):
    command = [sys.executable, "-m", "radiosity", *RUN, "--rays", str(LINES), "--live", "--port", "0"]
    run = subprocess.Popen(
        [*command, "-o", str(tmp_path / "live.npz")], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert run.stdout is not None
        url = run.stdout.readline().strip()
        with browser() as context:
            page = context.pages[0]
            page.goto(f"{url}/?fixedDpr=1")
            page.get_by_text(re.compile(r"stage \d+, [\d,]+ lines, relative error")).wait_for()
            page.get_by_text("Convergence").first.wait_for()
            page.add_style_tag(content=".mantine-Notification-root {display: none !important}")
            assert pixels(page)[:, :520].any(), "the solution so far is drawn"
            page.mouse.click(300, 350)
            page.get_by_text("lines that hit it").wait_for()
            assert run.poll() is None, "the run goes on behind the page"
        out, err = run.communicate(timeout=120)
    finally:
        run.kill()
        run.wait()
    assert run.returncode == 0, err
    assert "Traceback" not in err
    assert f"wrote {tmp_path / 'live.npz'}" in out
    live = rd.load_solution(tmp_path / "live.npz")
    patches = rd.subdivide(rd.load_scene("room"), cells=4)
    plain = rd.solve(patches, "random-walk", rays=LINES, seed=3)
    assert (live.status, live.quanta) == ("complete", plain.quanta)
    for name in ("irradiance", "irradiance_standard_error", "arrivals"):
        np.testing.assert_array_equal(getattr(live, name), getattr(plain, name))
