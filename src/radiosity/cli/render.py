"""``radiosity render``"""

from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from ..errors import OutputError, SceneError, printable
from . import amounts, outputs
from .false_colors import range_of
from .options import Count, Flag, Height, Outputs, Pair, Point, Seed, Stops
from .streams import tell


@dataclass(frozen=True)
class Viewpoint:
    """The point from which the scene is seen.

    Attributes:
        camera: Number of the scene's camera, from 0. Default: the first, or one fitted to the scene.
        origin: A camera of your own: where it stands, in metres, such as 1,2,1.5.
        target: What it looks at, in metres.
        up: Its upward direction. Default: the one usual in the scene's format.
        fov: Its vertical field of view, in degrees.
        plan: A plan from above instead: the height at which it cuts the scene, in metres, such as 1.5. What is above is not seen.
        panorama: A view all around from --origin, with --target in the middle.
    """

    camera: int | None = None
    origin: Point = None
    target: Point = None
    up: Point = None
    fov: float | None = None
    plan: Height = None
    panorama: Flag = False


@dataclass(frozen=True)
class Picture:
    """What a picture shows, and how.

    Attributes:
        width: Of the picture, in pixels. Default: the camera's, 800 of one that is fitted, 1024 of a panorama.
        height: Of the picture, in pixels. Default: follows from the width.
        exposure: Stops brighter than the automatic scale; +1 is twice.
        smooth: Interpolate within surfaces, or show each patch as it is.
        quantity: radiosity, irradiance, standard_error, irradiance_standard_error, relative_error, radiance, or
            luminance in cd/m².
        band: One band, by name or number. Default: all.
        false_color: Colours for values, with a legend in physical units.
        limits: Of false colours: lowest and highest value of the legend, such as 0,500.
        log: Of false colours: a logarithmic legend.
        color_map: Of false colours: one of matplotlib's. Default: viridis.
        samples: Lines of sight for each pixel, 1 to 1024; more of them make smoother edges. Default: 4.
        final_gather: Lines for each pixel, such as 256, that find the light at the points that are seen: shadow rays go to lamps,
            and others read the solution. Shadows are sharp then, whatever the size of patches. Default: no such lines.
        seed: Of the final gather. Equal seeds give equal pictures.
        denoise: Of the final gather: filter its noise within surfaces.
        cluster: Of the final gather: trace on the workers of Dask, as of `radiosity solve`: tcp://HOST:PORT, or local:N.
        tone_map: What is done with bright light: clip it, or let it roll off as film does (filmic, or agx with less contrast).
    """

    width: int | None = None
    height: int | None = None
    exposure: Stops = None
    smooth: bool = True
    quantity: str = "radiosity"
    band: str | None = None
    false_color: Flag = False
    limits: Annotated[Pair, Parameter(name="--range")] = None
    log: Flag = False
    color_map: str | None = None
    samples: Count = None
    final_gather: Count = None
    seed: Seed = 0
    denoise: Flag = False
    cluster: str | None = None
    tone_map: Literal["clip", "filmic", "agx"] = "clip"


class Unset:
    """Each group of options where none of them is given."""

    viewpoint, picture = Viewpoint(), Picture()


def render(
    solution: Path,
    /,
    *,
    output: Outputs,
    viewpoint: Annotated[Viewpoint, Parameter(name="*")] = Unset.viewpoint,
    picture: Annotated[Picture, Parameter(name="*")] = Unset.picture,
) -> None:
    """Render a saved solution to pictures.

    Parameters
    ----------
    solution
        An .npz file that `radiosity solve` wrote.
    output
        Pictures to write: .png to look at, .exr to measure in.
    """
    outputs.check(output)
    for path in output:
        if path.suffix.lower() not in (".png", ".exr"):
            raise OutputError(f"{path}: pictures are .png or .exr; meshes and tables come from `radiosity solve`")
    if not output:
        raise OutputError("no output; name a picture with -o, such as -o view.png")
    if picture.seed and picture.final_gather is None:
        raise OutputError(f"--seed {picture.seed} is that of a final gather: give --final-gather N, or leave it out")
    interval = range_of(picture)

    import radiosity as rd

    from ..image import render as draw
    from .progress import bar

    loaded = rd.load_solution(solution)
    view = _view(loaded.patches.scene, viewpoint, picture.width, picture.height)

    def written(path: Path) -> None:
        with bar() as progress:
            draw(
                loaded,
                path,
                camera=view,
                width=picture.width,
                height=picture.height,
                exposure=picture.exposure,
                smooth=picture.smooth,
                quantity=picture.quantity,
                band=picture.band,
                false_color=picture.false_color,
                range=interval,
                log=picture.log,
                color_map=picture.color_map or "viridis",
                samples=4 if picture.samples is None else picture.samples,
                final_gather=picture.final_gather,
                seed=picture.seed,
                denoise=picture.denoise,
                tone_map=picture.tone_map,
                progress=progress if picture.final_gather else None,
                cluster=picture.cluster,
            )
        tell(f"wrote {printable(path)}")

    failures = outputs.attempt((path, partial(written, path)) for path in output)
    if len(failures) == 1:
        raise next(iter(failures.values()))
    if failures:
        raise OutputError("; ".join(outputs.told(failures)))


def _view(scene, viewpoint: Viewpoint, width: int | None = None, height: int | None = None):
    """The camera asked for: a `Camera`, the number of one of the scene's, or None for what the renderer chooses."""
    from dataclasses import replace

    from ..scene import Camera
    from ..scene.up import up_vector

    number, origin, target, up, fov, cut, around = (getattr(viewpoint, field.name) for field in fields(viewpoint))
    if cut is not None:
        if any(value is not None for value in (number, origin, target, up, fov)) or around:
            raise SceneError("--plan chooses its own view: leave --camera, --origin, --target, --up, --fov and --panorama out")
        from ..image.projections import plan

        return plan(scene, cut=cut, width=width, height=height)
    if around and (origin is None or fov is not None):
        raise SceneError("--panorama needs --origin and --target, and takes no --fov")
    if (origin is None) != (target is None):
        raise SceneError("--origin and --target go together: where the camera stands and what it looks at")
    if number is not None and origin is not None:
        raise SceneError("give --camera, or --origin and --target, not both")
    changes: dict[str, Any] = {
        name: amounts.numbers(text, 3) for name, text in (("origin", origin), ("target", target), ("up", up)) if text
    }
    if fov is not None:
        changes["fov"] = fov
    if origin is not None:
        changes = {"up": up_vector(scene), **changes}
        if around:
            from ..image.projections import Panorama

            return Panorama(**changes)
        return Camera(**changes)
    if not changes or (number is not None and not 0 <= number < len(scene.cameras)):
        return number
    if not scene.cameras:
        raise SceneError("the scene has no camera for --up or --fov to change; give --origin and --target too")
    return replace(scene.cameras[number or 0], **changes)
