"""Views of the scene: as it looks, and in false colours."""

import io

import numpy as np

from ..image import false_color
from ..image.picture import choose_camera, first_hits, take
from ..image.quantity import choose
from ..image.render import render
from ..solution.model import Solution
from .markup import Markup, element, figure, png_image, section
from .wishes import Wishes
from .words import Words

MOST = 4  # cameras of the scene that are taken by themselves
TOP = 97.0  # percentile of the view outside lamps at which false colours end: what lies beside lamps is no place to work at
LETTERS = 1.6  # of the legend: some 9 points on paper


def views(solution: Solution, wishes: Wishes, progress=None) -> Markup:
    """Return a picture by each camera, and one in false colours by the first.

    Raises:
        SceneError, OutputError: a camera does not exist, or can take no picture.
    """
    scene, words = solution.patches.scene, Words.of(solution.patches.scene)
    cameras = list(wishes.cameras or range(min(len(scene.cameras), MOST))) or [None]
    gather = {}
    if wishes.final_gather is not None:
        gather = {"final_gather": wishes.final_gather, "seed": wishes.seed, "progress": progress, "denoise": True}
    parts = []
    for place, camera in enumerate(cameras, 1):
        pixels = render(solution, camera=camera, width=wishes.width, **gather)
        name = f"View {place}" if len(cameras) > 1 else "View"
        parts.append(figure(_image(pixels, f"{name} of the scene, as the calculation shows it"), f"{name} of the scene"))
    pixels = _falling(solution, cameras[0], wishes.width)
    title = f"{words.falling.capitalize()} in colours: the legend gives {words.falling_unit}"
    parts.append(figure(_image(pixels, f"{words.falling.capitalize()} on all surfaces in false colours, with a legend"), title))
    intro = "The pictures show diffuse surfaces in the calculated light. Gloss, reflections in mirrors and glare are not in them."
    return section("Views", element("p", intro, class_="small"), *parts, kind="page views")


def _falling(solution: Solution, camera, width: int) -> np.ndarray:
    """Return a picture of the light that falls on surfaces, in false colours, with a legend that can be read on paper."""
    shown = choose(solution, "irradiance", single=True)
    taken = take(solution, shown, choose_camera(solution, camera, width, None, first_hits))
    return false_color.colour(taken, title=shown.title, unit=shown.unit, top=TOP, letters=LETTERS)


def _image(pixels: np.ndarray, alt: str) -> Markup:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(file, "PNG", optimize=True)
    return png_image(file.getvalue(), alt)
