"""A run in the browser while it goes on: the solution of each stage, and how its error falls."""

import time
from math import isfinite

from ..run.progress import Progress
from ..solution import Solution
from . import convergence
from .numbers import plain
from .view import Viewer

OFTEN = 0.25  # seconds between texts
FIRST = -1.0  # the place above all other parts of the panel


class Live:
    """The page of a run. Give `progress` and `watch` to `solve`; neither changes the run, whatever becomes of the page.

    Attributes:
        viewer: the page.
        rays, errors: of the stages so far, whose errors are known: lines, and relative errors in %.
    """

    def __init__(self, viewer: Viewer):
        self.viewer = viewer
        self.rays: list[float] = []
        self.errors: list[float] = []
        self._told = 0.0
        viewer.added = self._draw

    def progress(self, state: Progress) -> None:
        """Tell how far the run is."""
        now = time.perf_counter()
        if now - self._told > OFTEN:
            self._told = now
            left = "" if state.seconds_left is None else f", {state.seconds_left:.0f} s left"
            error = f", relative error {100 * state.error:.3g} %" if isfinite(state.error) else ""
            self._say(f"{state.message or 'tracing'}: stage {state.stage + 1}, {state.rays:,} lines{error}{left}")

    def watch(self, solution: Solution) -> None:
        """Show the solution of a stage, and its error in the plot."""
        if isfinite(solution.error) and solution.error > 0:
            self.rays.append(float(solution.rays))
            self.errors.append(100 * solution.error)
        self.viewer.show(solution)

    def finish(self, solution: Solution) -> None:
        """Show the result of the run, and how it ended."""
        self.viewer.show(solution)
        error = f", relative error {100 * solution.error:.3g} %" if isfinite(solution.error) else ""
        self._say(f"**{plain(solution.status)}** after {solution.rays:,} lines{error}")

    def _draw(self) -> None:
        """Draw the plot; the page's thread calls it."""
        rays, errors = list(self.rays), list(self.errors)
        if not rays:
            return
        parts, picture = self.viewer.panel.parts, convergence.plot(rays[: len(errors)], errors[: len(rays)])
        if "plot" in parts:
            parts["plot"].image = picture
        else:
            parts["plot"] = self.viewer.server.gui.add_image(picture, format="png", label="Convergence", order=FIRST / 2)

    def _say(self, text: str) -> None:
        parts = self.viewer.panel.parts
        if "run" in parts:
            parts["run"].content = text
        else:
            parts["run"] = self.viewer.server.gui.add_markdown(text, order=FIRST)
