"""Hashes of the results of some thirty small runs: for a change that must leave every bit as it was.

Run it before and after (``python benchmarks/bits.py > before.txt``), on the same machine, and compare the two files. Only public
names are used, so that the code before and after may be built in different ways.
"""

import hashlib
import warnings

import radiosity as rd

FIELDS = ("radiosity", "standard_error", "irradiance", "irradiance_standard_error", "arrivals")
CHOICES = {
    "random-walk": (
        {"order": "depth-first"},
        {"numbers": "sobol"},
        {"numbers": "random"},
        {"randomisation": "shared"},
        {"coherent": True},
        {"estimator": "absorption"},
        {"absorption": "fractional"},
        {"estimator": "gathering"},
    ),
}


def runs():
    """Name, patches, method, choices and budget of each run."""
    colors = rd.subdivide(rd.load_scene("cornell-box"), cells=3)
    grey = rd.subdivide(rd.load_scene("room"), cells=3)
    for method in rd.PRESETS:
        yield "room", grey, method, {}, {"rays": 60_000, "replicates": 3}
        for choices in CHOICES.get(method, ()):
            yield "room", grey, method, choices, {"rays": 60_000, "replicates": 3}
    for method in ("random-walk", "particle-tracing", "stochastic-jacobi", "transillumination", "global-multipath", "wdrs"):
        yield "cornell-box", colors, method, {}, {"rays": 60_000, "replicates": 3}
    for method in rd.BASELINES:
        yield "room", rd.subdivide(rd.load_scene("room"), cells=2), method, {}, {}


def digest(solution: rd.Solution) -> str:
    """The first 16 digits of the SHA-256 of all fields."""
    found = hashlib.sha256()
    for field in FIELDS:
        found.update(getattr(solution, field).tobytes())
    found.update(repr((solution.rays, solution.quanta, solution.books)).encode())
    return found.hexdigest()[:16]


def main() -> None:
    warnings.simplefilter("ignore")
    for scene, patches, method, choices, budget in runs():
        name = " ".join([scene, method, *(f"{key}={value}" for key, value in choices.items())])
        try:
            print(digest(rd.solve(patches, method, seed=5, **budget, **choices)), name, flush=True)
        except rd.RadiosityError as error:
            print("refused         ", name, error, flush=True)


if __name__ == "__main__":
    main()
