"""Lines a second of every method on one scene, in one run, warm; and their errors at equal lines."""

import time

from history import note

import radiosity as rd

RAYS = 10_000_000
ROW = "{:<36} {:>8} {:>9} {:>10} {:>8} {:>9}"


def methods(scene: str = "room", cells: int = 12) -> None:
    """One row a method: lines as the paper counts them (a local line 1, a span 2)."""
    patches = rd.subdivide(rd.load_scene(scene), cells=cells)
    print(f"methods on {scene}, {len(patches)} patches, {RAYS:,} lines, 8 replicates; rates in million lines a second, warm")
    print(ROW.format("method", "seconds", "lines/s", "of first", "error", "lines"))
    first = None
    walks = {
        "continuous, random": rd.Method(equation="continuous", numbers="random"),
        "discrete, drawn": rd.Method(absorption="drawn"),
        "discrete, random": rd.Method(numbers="random"),
        "gathering": rd.Method(estimator="gathering"),
        "matrix, local lines": rd.Method(order="matrix"),
    }
    for name, method in {**{name: preset.method for name, preset in rd.PRESETS.items()}, **walks}.items():
        best, solution = float("inf"), None
        for _ in range(3):  # the first compiles
            begun = time.perf_counter()
            solution = rd.solve(patches, method, rays=RAYS)
            best = min(best, time.perf_counter() - begun)
        assert solution is not None
        rate = solution.rays / best / 1e6
        first = first or rate
        note(f"{name} on {scene}, {len(patches)} patches", rate, "M/s")
        lines = f"{solution.rays / 1e6:.1f} M"
        print(ROW.format(name, f"{best:.2f}", f"{rate:.1f}", f"{rate / first:.2f}", f"{solution.error:.2%}", lines), flush=True)


if __name__ == "__main__":
    methods()
