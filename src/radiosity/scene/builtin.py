"""Scenes that come with the program, by name."""

import numpy as np

from .model import Scene
from .rooms import rooms
from .shapes import box, join, quad
from .studio import studio

CEILING_LIGHT = 40.0  # W/m²


def cornell_box() -> Scene:
    """The Cornell box (Cornell University Program of Computer Graphics, measured data of 1998), in metres, RGB.

    Colours are the measured spectra reduced to three bands, as used by most renderers; the light's exitance is
    pi times the radiance (17, 12, 4) W/(m² sr). The light hangs 1 mm below the ceiling, where copies of the published data
    have 0.1 mm: less than the ray offset of many programs, which then shine through it.
    """
    white, green, red = (0.725, 0.71, 0.68), (0.14, 0.45, 0.091), (0.63, 0.065, 0.05)
    quads = [
        ("floor", white, [(552.8, 0, 0), (0, 0, 0), (0, 0, 559.2), (549.6, 0, 559.2)]),
        ("ceiling", white, [(556, 548.8, 0), (556, 548.8, 559.2), (0, 548.8, 559.2), (0, 548.8, 0)]),
        ("back wall", white, [(549.6, 0, 559.2), (0, 0, 559.2), (0, 548.8, 559.2), (556, 548.8, 559.2)]),
        ("right wall", green, [(0, 0, 559.2), (0, 0, 0), (0, 548.8, 0), (0, 548.8, 559.2)]),
        ("left wall", red, [(552.8, 0, 0), (549.6, 0, 559.2), (556, 548.8, 559.2), (556, 548.8, 0)]),
        ("light", (0.78, 0.78, 0.78), [(343, 547.8, 227), (343, 547.8, 332), (213, 547.8, 332), (213, 547.8, 227)]),
        ("short block", white, [(130, 165, 65), (82, 165, 225), (240, 165, 272), (290, 165, 114)]),
        ("short block", white, [(290, 0, 114), (290, 165, 114), (240, 165, 272), (240, 0, 272)]),
        ("short block", white, [(130, 0, 65), (130, 165, 65), (290, 165, 114), (290, 0, 114)]),
        ("short block", white, [(82, 0, 225), (82, 165, 225), (130, 165, 65), (130, 0, 65)]),
        ("short block", white, [(240, 0, 272), (240, 165, 272), (82, 165, 225), (82, 0, 225)]),
        ("tall block", white, [(423, 330, 247), (265, 330, 296), (314, 330, 456), (472, 330, 406)]),
        ("tall block", white, [(423, 0, 247), (423, 330, 247), (472, 330, 406), (472, 0, 406)]),
        ("tall block", white, [(472, 0, 406), (472, 330, 406), (314, 330, 456), (314, 0, 456)]),
        ("tall block", white, [(314, 0, 456), (314, 330, 456), (265, 330, 296), (265, 0, 296)]),
        ("tall block", white, [(265, 0, 296), (265, 330, 296), (423, 330, 247), (423, 0, 247)]),
    ]
    from .model import Camera

    names = tuple(dict.fromkeys(name for name, _, _ in quads))
    emission = [np.pi * np.array((17.0, 12.0, 4.0)) if name == "light" else (0, 0, 0) for name, _, _ in quads]
    return Scene.from_arrays(
        np.array([corner for _, _, corners in quads for corner in corners]) / 1000,
        np.arange(4 * len(quads)).reshape(-1, 4),
        np.array([color for _, color, _ in quads]),
        np.array(emission),
        two_sided=[name == "light" for name, _, _ in quads],
        back_emission=np.zeros((1, 3)),
        surface=[names.index(name) for name, _, _ in quads],
        names=names,
        cameras=(Camera((0.278, 0.273, -0.8), (0.278, 0.273, -0.799), (0, 1, 0), 39.3077, 600, 600),),
        source="cornell-box",
    )


def room() -> Scene:
    """A room of 6 x 4 x 3 m with two boxes on its floor and a small ceiling light: the paper's box scene, our own measures."""
    from .model import Camera

    walls = box((0, 0, 0), (6, 4, 3), inward=True)
    names = ("south wall", "north wall", "west wall", "east wall", "floor", "ceiling")
    parts = [
        (name, 0.7 if name == "ceiling" else 0.3 if name == "floor" else 0.5, 0.0, [face])
        for name, face in zip(names, walls, strict=True)
    ]
    parts.append(
        (
            "low box",
            0.6,
            0.0,
            box((1.0, 0.8, 0), (2.2, 2.0, 0.8), turn=20)[:-2] + box((1.0, 0.8, 0), (2.2, 2.0, 0.8), turn=20)[-1:],
        )
    )
    parts.append(
        (
            "tall box",
            0.6,
            0.0,
            box((3.6, 2.0, 0), (4.6, 3.0, 1.8), turn=-15)[:-2] + box((3.6, 2.0, 0), (4.6, 3.0, 1.8), turn=-15)[-1:],
        )
    )
    parts.append(("light", 0.0, CEILING_LIGHT, [quad((2.6, 1.6, 2.99), (0, 0.8, 0), (0.8, 0, 0))]))
    camera = Camera((0.25, 0.25, 1.9), (4.0, 2.6, 0.8), (0, 0, 1), 62.0, 800, 600)
    return join(parts, source="room", cameras=(camera,), backs={"light": 0.7})


def labyrinth(mean_reflectance: float = 0.5, cells: int = 4) -> Scene:
    """A closed maze furnace: reflectance differs from face to face, emission is 1 - reflectance, so B = 1 everywhere.

    The maze is ours (the paper's is only drawn): a square of 4 m with six inner walls, 1 m high; every wall, floor
    and ceiling is cut into faces of about 1 m, each with its own reflectance.

    Args:
        mean_reflectance: area-weighted, met exactly.
        cells: unit squares along the maze's side (the inner walls need 4 or more).
    """
    from .maze import maze_quads

    return maze_quads(mean_reflectance, cells)


SCENES = {
    "cornell-box": cornell_box,
    "room": room,
    "rooms": rooms,
    "studio": studio,
    "labyrinth": labyrinth,
    "labyrinth-0.1": lambda: labyrinth(0.1),
    "labyrinth-0.5": lambda: labyrinth(0.5),
    "labyrinth-0.9": lambda: labyrinth(0.9),
}
