"""``radiosity render``"""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..errors import OutputError, SceneError
from . import amounts, outputs
from .options import Flag, Outputs, Pair, Point


def render(
    solution: Path,
    /,
    *,
    output: Outputs,
    camera: int | None = None,
    origin: Point = None,
    target: Point = None,
    up: Point = None,
    fov: float | None = None,
    width: int | None = None,
    height: int | None = None,
    exposure: float | None = None,
    smooth: Flag = False,
    quantity: str = "radiosity",
    false_color: Flag = False,
    limits: Annotated[Pair, Parameter(name="--range")] = None,
    log: Flag = False,
) -> None:
    """Render a saved solution to pictures.

    Parameters
    ----------
    solution
        An .npz file that `radiosity solve` wrote.
    output
        Pictures to write, .png or .exr.
    camera
        Number of the scene's camera, from 0. Default: the first, or one fitted to the scene.
    origin
        A camera of your own: where it stands, in metres, such as 1,2,1.5.
    target
        What it looks at, in metres.
    up
        Its upward direction. Default 0,0,1.
    fov
        Its vertical field of view, in degrees.
    width
        Of the picture, in pixels.
    height
        Of the picture, in pixels.
    exposure
        In stops. Default: fitted.
    smooth
        Interpolate within surfaces instead of showing patches.
    quantity
        What to show: radiosity, irradiance or standard_error.
    false_color
        Colours for values, with a legend in physical units.
    limits
        Lowest and highest value of the legend, such as 0,500.
    log
        A logarithmic legend.
    """
    outputs.check(output)
    for path in output:
        if path.suffix.lower() not in (".png", ".exr"):
            raise OutputError(f"{path}: pictures are .png or .exr")
    if not output:
        raise OutputError("no output; name a picture with -o, such as -o view.png")

    import radiosity as rd

    from ..image import render as draw

    loaded = rd.load_solution(solution)
    view = _view(loaded.patches.scene, camera, origin, target, up, fov)
    interval = None if limits is None else amounts.numbers(limits, 2)
    for path in output:
        draw(
            loaded, path, camera=view, width=width, height=height, exposure=exposure, smooth=smooth, quantity=quantity,
            false_color=false_color, range=interval, log=log,
        )  # fmt: skip
        print(f"wrote {path}")


def _view(scene, number: int | None, origin: str | None, target: str | None, up: str | None, fov: float | None):
    """The camera asked for, or None for the one that the renderer chooses."""
    from dataclasses import replace

    from ..scene.model import Camera

    if (origin is None) != (target is None):
        raise SceneError("--origin and --target go together: where the camera stands and what it looks at")
    if number is not None and not 0 <= number < len(scene.cameras):
        raise SceneError(f"--camera is {number}; the scene has {len(scene.cameras)} cameras, numbered from 0")
    if number is not None and origin is not None:
        raise SceneError("give --camera, or --origin and --target, not both")
    points = {name: amounts.numbers(text, 3) for name, text in (("origin", origin), ("target", target), ("up", up)) if text}
    if fov is not None:
        if not 0 < fov < 180:
            raise SceneError(f"--fov is {fov:g}; it must lie between 0 and 180 degrees")
        points["fov"] = fov
    if origin is not None:
        return Camera(**points)
    known = scene.cameras[number or 0] if scene.cameras else None
    if known is None and points:
        raise SceneError("the scene has no camera for --up or --fov to change; give --origin and --target too")
    return replace(known, **points) if known and (points or number is not None) else None
