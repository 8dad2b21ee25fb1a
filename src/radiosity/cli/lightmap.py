"""``radiosity lightmap``"""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from ..errors import OutputError, printable
from . import outputs
from .options import Count, Density, Flag, Seed, Stops
from .streams import tell


@dataclass(frozen=True)
class Texture:
    """The texture, and the lines of its texels.

    Attributes:
        texels_per_metre: Texels per metre of a surface, such as 20. Default: as many as fit --size.
        size: Texels along the page, at most 8192. Default: 1024.
        lines: Lines of each texel, as of a final gather. Default: 256.
        samples: Points of each texel, which share its lines and make edges of shadows smooth. Default: 4.
        quantity: radiosity (what a surface sends: colours and images are in it), irradiance (what falls on it, to be multiplied
            by colours in another program), radiance, or luminance in cd/m².
        padding: Texels between charts, 2 or more. Default: 4.
        denoise: Filter the noise within planes of surfaces.
        errors: Write the standard errors of texels, too, to NAME.error.exr.
        seed: Equal seeds give equal lightmaps.
        cluster: Trace on the workers of Dask, as of `radiosity solve`: tcp://HOST:PORT, or local:N.
        exposure: Stops brighter than the automatic scale; +1 is twice.
        tone_map: What is done with bright light in the texture: clip, filmic, or agx. The EXR file has it as it is.
    """

    texels_per_metre: Density = None
    size: Count = None
    lines: Count = None
    samples: Count = None
    quantity: str = "radiosity"
    padding: Count = None
    denoise: Flag = False
    errors: Flag = False
    seed: Seed = 0
    cluster: str | None = None
    exposure: Stops = None
    tone_map: Literal["clip", "filmic", "agx"] = "clip"


PLAIN = Texture()


def lightmap(
    solution: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    texture: Annotated[Texture, Parameter(name="*")] = PLAIN,
) -> None:
    """Bake a lightmap of a saved solution: a GLB file with the light as a texture, and an EXR file with its values.

    Parameters
    ----------
    solution
        An .npz file that `radiosity solve` wrote.
    output
        The .glb file to write; NAME.exr is written beside it.
    """
    from ..image.look import Look
    from ..image.tone import chosen_scale
    from ..lightmap.model import check

    if output is None:
        raise OutputError("no output; name a file with -o, such as -o room.glb")
    written = check(output, errors=texture.errors)
    chosen_scale(Look(exposure=texture.exposure), lambda: 1.0)  # refuses what makes no sense before a line is traced

    import radiosity as rd

    from .progress import bar

    loaded = rd.load_solution(solution)
    outputs.spare([loaded.patches.scene.source], written)
    with bar() as progress:
        found = rd.bake_lightmap(
            loaded,
            texels_per_metre=texture.texels_per_metre,
            size=texture.size,
            lines=256 if texture.lines is None else texture.lines,
            samples=4 if texture.samples is None else texture.samples,
            quantity=texture.quantity,
            padding=4 if texture.padding is None else texture.padding,
            denoise=texture.denoise,
            errors=texture.errors,
            seed=texture.seed,
            progress=progress,
            cluster=texture.cluster,
        )
    height, width = found.covered.shape
    tell(f"{width} x {height} texels, {found.texels_per_metre:.4g} per metre, {found.covered.mean():.0%} of them on surfaces")
    for path in found.save(output, exposure=texture.exposure, tone_map=texture.tone_map):
        tell(f"wrote {printable(path)}")
