"""Marks of what is no surface: sensors, luminaires, suns and openings."""

from typing import TYPE_CHECKING

import numpy as np

from ..image.tone import luminance
from ..sensors.model import Sensors
from .frame import Frame
from .library import Server

if TYPE_CHECKING:
    from ..scene import Scene

SENSOR, LUMINAIRE, SUN, OPENING = (0, 200, 255), (255, 170, 0), (255, 230, 60), (120, 255, 120)
SHARE = 0.006  # of the scene's size: the size of a mark
MOST = 20_000  # sensors of a set with an arrow each
LABELS = 60  # names of luminaires


def add(server: Server, scene: "Scene", frame: Frame) -> list[str]:
    """Put marks on the page below ``/marks``; return a line of text about each kind."""
    size = float(np.ptp(scene.bounds, axis=0).max()) * frame.scale
    server.scene.add_frame("/marks", show_axes=False)
    return [*_sensors(server, scene, frame, size), *_luminaires(server, scene, frame, size), *_sky(server, scene, frame, size)]


def _sensors(server, scene, frame: Frame, size: float) -> list[str]:
    if not scene.sensors:
        return []
    sensors, told = Sensors.of_scene(scene), []
    for number, name in enumerate(sensors.names):
        rows = np.flatnonzero(sensors.set == number)
        points, steps = frame.to_page(sensors.points[rows]), sensors.spacings[number]
        spacing = float(np.min(steps)) * frame.scale if np.isfinite(steps).all() else 4 * SHARE * size
        length = min(0.4 * spacing, 4 * SHARE * size)
        if len(rows) <= MOST:
            tips = points + length * sensors.normals[rows]
            _arrows(server, f"/marks/sensors {number}", np.stack([points, tips], axis=1), SENSOR, length)
        server.scene.add_point_cloud(
            f"/marks/points {number}", points, SENSOR, point_size=length / 5, precision="float32", point_shading="flat"
        )
        told.append(f"{len(rows)} sensors '{name}'")
    return told


def _luminaires(server, scene, frame: Frame, size: float) -> list[str]:
    lamps = scene.lights.luminaires
    if not lamps:
        return []
    points = frame.to_page(np.array([lamp.position for lamp in lamps]))
    down = np.array([lamp.axes[2] for lamp in lamps])
    length = 5 * SHARE * size
    _arrows(server, "/marks/luminaires", np.stack([points, points + length * down], axis=1), LUMINAIRE, length)
    server.scene.add_point_cloud(
        "/marks/lamps",
        points,
        LUMINAIRE,
        point_size=2 * SHARE * size,
        precision="float32",
        point_shape="circle",
        point_shading="flat",
    )
    for number, lamp in enumerate(lamps[:LABELS]):
        server.scene.add_label(f"/marks/name {number}", lamp.name, position=points[number], font_screen_scale=0.8)
    unit = "lm" if lamps[0].photometric else "W"
    told = f"{len(lamps)} luminaires, {sum(float(luminance(lamp.power)) for lamp in lamps):.4g} {unit} in all"
    return [told + (f" (the first {LABELS} have their names)" if len(lamps) > LABELS else "")]


def _sky(server, scene, frame: Frame, size: float) -> list[str]:
    told, lights = [], scene.lights
    middle = frame.to_page(scene.bounds.mean(axis=0))
    for number, sun in enumerate(lights.suns):
        away = np.asarray(sun.direction, np.float64)
        _arrows(
            server, f"/marks/sun {number}", np.stack([middle + away * size, middle + away * size * 0.75])[None], SUN, size / 12
        )
        told.append("a sun, whose arrow shows where its light goes")
    if lights.sky is not None:
        told.append("a sky around the scene")
    if lights.openings is not None:
        corners = frame.to_page(lights.openings)
        lines = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2, 3)
        server.scene.add_line_segments("/marks/openings", lines.astype(np.float32), OPENING, line_width=2)
        told.append(f"{len(corners)} openings, as lines")
    return told


def _arrows(server, name: str, ends: np.ndarray, color, length: float) -> None:
    radius = 0.06 * length
    sizes = {"shaft_radius": radius, "head_radius": 2.5 * radius, "head_length": 5 * radius}
    server.scene.add_arrows(name, ends.astype(np.float32), color, **sizes)
