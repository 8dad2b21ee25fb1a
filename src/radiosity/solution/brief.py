"""A solution in five lines, and the parts that the report shares with it."""

import math

from ..errors import printable
from ..scene.photopic import photopic
from .percent import number, percent


def brief(solution) -> str:
    """Five lines: what was solved, how, and the results."""
    scene, unit = solution.patches.scene, solution.irradiance_unit
    solved = solution.quanta > 0
    mean = "unknown (no stage is complete yet)"
    if solved:
        middle, (low, high) = area_mean(solution), solution.scene_interval()
        mean = ", ".join(
            f"{name}{number(value)} {unit}{_within(value, a, b)}"
            for name, value, a, b in zip(_named(scene.bands), middle, low, high, strict=True)
        )
        one = photopic(scene, middle)
        mean += "" if one is None else f"; {number(float(one))} lx by photopic weights"
    return "\n".join(
        [
            f"Solution of {printable(scene.source)}: {len(solution.patches):,} patches of {len(scene.names)} surfaces, "
            f"bands {', '.join(scene.bands)}",
            f"  method      {solution.provenance['method']}, seed {solution.provenance['seed']}, "
            f"{solution.replicates} replicates",
            f"  lines       {solution.rays:,} in {solution.seconds:.2f} s, status: {solution.status}",
            f"  error       {percent(solution.error) if solved else '?'} relative, of all patches (RMS)",
            f"  irradiance  {mean}, mean over the scene",
        ]
    )


def area_mean(solution):
    """The mean irradiance over the scene, without sides that no line reached, (n_bands,)."""
    inside = ~solution.sides.left_out
    area = solution.patches.solid.area[inside]
    return area @ solution.irradiance[inside] / area.sum()


def _named(bands) -> list[str]:
    return [f"{name} " if len(bands) > 1 else "" for name in bands]


def _within(value: float, low: float, high: float) -> str:
    half = (high - low) / 2
    return f" ± {percent(half / value)}" if value > 0 and math.isfinite(half) else ""
