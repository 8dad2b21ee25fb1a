"""The scene `rooms`: five rooms in a row, with a lamp in the first and a desk in the last."""

from .camera import Camera
from .model import Scene
from .shapes import box, join, quad

COUNT = 5
LENGTH, WIDTH, HEIGHT = 4.0, 4.0, 2.8  # m, of each room
DOOR_WIDTH, DOOR_HEIGHT = 1.0, 2.0  # m
NEAR, FAR = 0.4, 2.6  # m, where doorways begin, in turns: so nobody sees through two of them straight on
LAMP = 400.0  # W/m²


def rooms() -> Scene:
    """Five rooms of 4 x 4 x 2.8 m in a row, joined by doorways, with a lamp in the first room and a desk in the last.

    Walls between rooms have no thickness, and reflect on both sides. About a ten-thousandth of the light reaches the last room.
    """
    parts, between = [], []
    for number in range(COUNT):
        x, called = number * LENGTH, f"room {number + 1}"
        south, north, west, east, floor, ceiling = box((x, 0, 0), (x + LENGTH, WIDTH, HEIGHT), inward=True)
        walls = [south, north, *([west] if number == 0 else []), *([east] if number == COUNT - 1 else [])]
        parts += [
            (f"{called} walls", 0.5, 0.0, walls),
            (f"{called} floor", 0.3, 0.0, [floor]),
            (f"{called} ceiling", 0.7, 0.0, [ceiling]),
        ]
        if number:
            name = f"wall {number}-{number + 1}"
            parts.append((name, 0.5, 0.0, _wall_with_door(x, NEAR if number % 2 else FAR)))
            between.append(name)
    end = COUNT * LENGTH
    parts.append(("desk", 0.4, 0.0, box((end - 1.6, 1.4, 0.7), (end - 0.8, 2.6, 0.74))))
    parts.append(("lamp", 0.0, LAMP, [quad((1.6, 1.6, HEIGHT - 0.02), (0, 0.8, 0), (0.8, 0, 0))]))
    backs = dict.fromkeys(between, 0.5) | {"lamp": 0.7}
    camera = Camera((end - LENGTH + 0.4, 3.6, 1.7), (end - 1.4, 1.6, 0.9), (0, 0, 1), 65.0, 800, 600)
    return join(parts, source="rooms", cameras=(camera,), backs=backs)


def _wall_with_door(x: float, door: float) -> list:
    """Return a wall across the rooms at x, with an opening from y = door on."""
    end = door + DOOR_WIDTH
    strips = (
        (0.0, door, 0.0, HEIGHT),
        (end, WIDTH, 0.0, HEIGHT),
        (door, end, DOOR_HEIGHT, HEIGHT),
    )
    return [quad((x, y0, z0), (0, y1 - y0, 0), (0, 0, z1 - z0)) for y0, y1, z0, z1 in strips]
