"""PNG and EXR files from the default camera."""

from .look import Look
from .render import render


def write(solution, path, look: Look, *, final_gather=None, denoise=False, tone_map="clip", seed=0, progress=None) -> None:
    """Write a picture; see `radiosity.image.render`."""
    render(
        solution,
        path,
        smooth=look.smooth,
        quantity=look.quantity,
        band=look.band,
        exposure=look.exposure,
        scale=look.scale,
        final_gather=final_gather,
        denoise=denoise,
        tone_map=tone_map,
        seed=seed,
        progress=progress,
    )
