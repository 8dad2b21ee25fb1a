"""Scene in, solution out: the one loop over stages."""

import math
import time
from dataclasses import asdict

import numpy as np

from ..errors import MethodError
from ..method import Method, resolve
from ..patches import Patches, subdivide
from ..scene.model import Scene
from ..solution.model import Solution
from .budget import Budget, Progressed, first_stage, next_quanta
from .progress import Interrupted, Listener, Progress, Stop


def solve(
    scene: "Scene | Patches",
    method: "str | Method" = "random-walk",
    *,
    rays: float | None = None,
    seconds: float | None = None,
    error: float | None = None,
    quanta: int | None = None,
    replicates: int = 8,
    seed: int = 0,
    device: str = "auto",
    equation: str | None = None,
    lines: str | None = None,
    order: str | None = None,
    numbers: str | None = None,
    coherent: bool | None = None,
    progress: Listener | None = None,
) -> Solution:
    """Solve B = E + rho F B.

    Args:
        scene: a `Scene` (cut into about 20 000 patches) or the `Patches` of one.
        method: a preset's name or a `Method`; ``equation``, ``lines``, ``order``, ``numbers`` and ``coherent`` replace its choices.
        rays, seconds, error, quanta: exactly one: lines traced in all (replicates together); wall time; relative error
            of the scene (`Solution.error`); or N of each replicate, which replays a run bit for bit.
        replicates: independent randomised runs; from 2 on there are standard errors.
        seed: with the same inputs, the same bits.
        device: "auto", "cpu" or "cuda".
        progress: called with a `Progress` after each sweep.

    Returns:
        The solution of the last complete stage. Ctrl-C ends the run early and returns what is there.

    Raises:
        SceneError: nothing emits. MethodError: a choice or budget that makes no sense. DeviceError: nothing to run on.
    """
    budget = Budget(rays, seconds, error, quanta)
    chosen = resolve(method, equation=equation, lines=lines, order=order, numbers=numbers, coherent=coherent)
    if isinstance(replicates, bool) or int(replicates) != replicates or replicates < 1:
        raise MethodError(f"replicates is {replicates}; it must be a whole number of 1 or more")
    if isinstance(seed, bool) or int(seed) != seed or seed < 0:
        raise MethodError(f"seed is {seed}; it must be a whole number of 0 or more")
    budget.check(replicates)
    if not isinstance(scene, Scene | Patches):
        raise MethodError(f"solve takes a Scene or Patches, not {type(scene).__name__}; load a file with load_scene")
    run = _Run(scene if isinstance(scene, Patches) else subdivide(scene), chosen, budget, int(replicates), int(seed), device, progress)
    return run.solve()


class _Run:
    """The loop's state."""

    def __init__(self, patches, method, budget, replicates, seed, device, listener):
        from .bands import BandGroups
        from .quanta import Source

        self.patches, self.method, self.budget = patches, method, budget
        self.replicates, self.seed, self.listener = replicates, seed, listener
        self.groups = BandGroups.of(patches)
        self.source = Source.of(patches, self.groups.emission.max(axis=1), self.groups.reflectance.max(axis=1))
        if self.groups.n_groups > 1 and method.order != "breadth-first":
            raise MethodError(
                f"order '{method.order}' cannot carry {self.groups.n_groups} different bands: band power travels with whole sweeps; "
                "take breadth-first, or solve one band at a time"
            )
        self.begun = time.perf_counter()
        self.device_name = device
        self.stop = Stop()
        self.rung = first_stage(replicates, len(patches))
        self.stage, self.lines, self.error = 0, 0, math.nan

    def solve(self) -> Solution:
        from .device import choose
        from .geometry import Geometry

        self._tell("compiling")
        device = choose(self.device_name)
        self.geometry = Geometry(self.patches, device)
        with self.stop.listening():
            return self._stages(device)

    def _stages(self, device) -> Solution:
        from ..method.order import run
        from .snapshot import Snapshot

        engine = self._engine()
        first = self._first_quanta()
        snapshot, status, target = None, "complete", first
        self.tracing_since = time.perf_counter()
        while target is not None:
            started, self.goal = time.perf_counter(), snapshot and (snapshot.quanta, snapshot.lines)
            engine.set_quanta(target)
            try:
                run(self.method.order, engine, self._swept)
            except Interrupted as reason:
                status = str(reason)
                break
            snapshot = Snapshot.of(engine)
            self.stage, self.lines = self.stage + 1, snapshot.lines
            self.error = self._error_of(snapshot) if self.replicates > 1 else math.nan
            if self.stop.asked:
                status = "interrupted"
                break
            now = time.perf_counter()
            target = next_quanta(self.budget, self.replicates, self.rung, Progressed(target, snapshot.lines, now - self.begun, now - started, self.error))
        if snapshot is None:
            raise KeyboardInterrupt
        if self.budget.error is not None and status == "complete" and not self.error <= self.budget.error:
            status = "counters full before the target error was reached; take more replicates"
        return self._solution(snapshot, status, device)

    def _engine(self, replicates: int | None = None):
        from .firing import Engine

        return Engine(self.geometry, self.source, self.method, self.seed, replicates or self.replicates, self.groups)

    def _first_quanta(self) -> int:
        """N of the first stage: the ladder's first rung, or less where the budget asks for less."""
        rung = self.rung
        if self.budget.quanta is not None:
            return min(rung, int(self.budget.quanta))
        if self.budget.rays is None or self.budget.rays >= 8 * rung * self.replicates:
            return rung
        return self._few_quanta(rung)

    def _few_quanta(self, rung: int) -> int:
        """For a small number of rays: lines that a quantum takes, measured in a run that is thrown away."""
        from ..method.order import run

        wanted = self.budget.rays / self.replicates
        trial = max(1, min(rung, math.ceil(wanted)))
        engine = self._engine()
        engine.set_quanta(trial)
        self.tracing_since, self.goal = time.perf_counter(), None
        run(self.method.order, engine, lambda count: None)
        lines = int(engine.counters()[1].sum(dtype=np.uint64))
        found = max(1, round(trial * self.budget.rays / max(lines, 1)))
        if found < 20 * math.sqrt(len(self.patches)):
            import warnings

            from ..errors import RadiosityWarning

            warnings.warn(
                f"{self.budget.rays:g} lines give each of {self.replicates} replicates {found} quanta for {len(self.patches)} patches; "
                f"with fewer than {20 * math.sqrt(len(self.patches)):.0f} the number of lines is met only roughly, and errors are large",
                RadiosityWarning, stacklevel=5,
            )  # fmt: skip
        return min(rung, found)

    def _swept(self, count: int) -> None:
        self.lines += count
        self._tell("tracing")
        if self.stop.asked:
            raise Interrupted("interrupted")
        late = self.budget.seconds is not None and time.perf_counter() - self.begun > 1.2 * self.budget.seconds + 1
        if late and self.stage > 0:
            raise Interrupted("complete")

    def _tell(self, message: str) -> None:
        if self.listener is None:
            return
        elapsed = time.perf_counter() - self.begun
        tracing = time.perf_counter() - getattr(self, "tracing_since", self.begun)
        rate = self.lines / tracing if tracing > 0 and self.lines else 0.0
        fraction, left = None, None
        if self.budget.seconds is not None:
            fraction, left = elapsed / self.budget.seconds, self.budget.seconds - elapsed
        elif self.budget.rays is not None:
            fraction = self.lines / self.budget.rays
            left = (self.budget.rays - self.lines) / rate if rate else None
        elif self.budget.error is not None and self.error > 0:
            needed = self.lines * max((self.error / self.budget.error) ** (1 / 0.6), 1.0) if self.stage else None
            fraction = None if not needed else min(self.lines / needed, (self.budget.error / self.error) ** (1 / 0.6))
            left = (needed - self.lines) / rate if needed and rate else None
        elif self.budget.quanta is not None and getattr(self, "goal", None):
            whole = self.goal[1] * self.budget.quanta / self.goal[0]
            fraction = self.lines / whole if whole else None
            left = (whole - self.lines) / rate if rate and whole else None
        clipped = None if fraction is None else min(max(fraction, 0.0), 1.0)
        self.listener(Progress(self.stage, self.lines, rate, self.error, clipped, None if left is None else max(left, 0.0), message))

    def _error_of(self, snapshot) -> float:
        return self._solution(snapshot, "", None).error

    def _solution(self, snapshot, status: str, device) -> Solution:
        n_bands = self.patches.scene.n_bands
        mean, error = (np.zeros((len(self.patches), n_bands)) for _ in range(2))
        groups = [snapshot.irradiance(self.source, self.patches.area, g) for g in range(self.groups.n_groups)]
        for band, (group, scale) in enumerate(zip(self.groups.index, self.groups.scale, strict=True)):
            mean[:, band], error[:, band] = groups[group][0] * scale, groups[group][1] * scale
        books = self._books(snapshot) if device is not None else ()
        state = {} if device is None else {"arrivals": snapshot.arrivals, "fired": snapshot.fired, "missed": snapshot.missed}
        return Solution(
            self.patches, mean, error, snapshot.arrivals.sum(axis=0, dtype=np.int64), snapshot.lines, time.perf_counter() - self.begun,
            snapshot.quanta, self.replicates, books, status, self._provenance(device) if device is not None else {}, state,
        )  # fmt: skip

    def _books(self, snapshot) -> tuple[dict, ...]:
        result = []
        for group, scale in zip(self.groups.index, self.groups.scale, strict=True):
            book = snapshot.books(self.source, self.groups, int(group), self.patches.area)
            unit = book.watts * scale
            powers = {name: getattr(book, name) * unit for name in ("emitted", "rounding", "absorbed", "escaped", "lost")}
            result.append(powers | {"closes": book.closes})
        return tuple(result)

    def _provenance(self, device) -> dict:
        from importlib.metadata import version

        return {
            "scene": self.patches.scene.hash, "source": self.patches.scene.source, "method": str(self.method),
            "choices": asdict(self.method), "seed": self.seed, "replicates": self.replicates, "device": device.name,
            "budget": {k: v for k, v in vars(self.budget).items() if v is not None},
            "versions": {name: version(name) for name in ("radiosity", "drjit", "mitsuba", "numpy")},
        }  # fmt: skip
