"""Pictures after figures 1 to 3 of the paper: kinds of sample lines, the orders in which they are fired, and the scenes."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from ..patches import subdivide
from ..scene import Camera, load_scene
from ..scene.model import Scene
from .figures import COLOURS, STYLE
from .sample_lines import breadth_first, chords, crossings, depth_first, local_lines, spans, sphere, walks
from .study import FULL, Protocol

BLUE, ORANGE = COLOURS[:2]
LINES = 16_000_000  # of the room's picture, at most
MAZE = "labyrinth-0.9"
CORNER = Camera((0.12, 0.12, 2.3), (3.3, 2.35, 0.95), (0, 0, 1), 82.0, 800, 600)  # sees the light and both boxes
THICK = 0.09  # metres, thickness of a wall's side in the plan
TURN, TILT = np.deg2rad(-22.0), np.deg2rad(24.0)  # angles of the view into the room
PATCH_AT, LOCAL, LOCAL_SEED = (3.5, 1.0, 0.0), 14, 3
CHORDS, CHORDS_SEED = 12, 1578
PARTICLES, WALKS_SEED = 4, 84


def scenes(path: Path, protocol: Protocol = FULL) -> list[Path]:
    """Draw figure 3: the room, solved and rendered, and the maze from above with the reflectance of its patches."""
    import matplotlib

    from ..image import render
    from ..run.solve import solve

    patches = subdivide(load_scene("room"), size=0.1)
    solution = solve(patches, rays=min(LINES, 64 << protocol.last), seed=protocol.seed, device="cpu")
    with matplotlib.rc_context(STYLE):
        figure = _figure(9.2, 4.0)
        left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
        left.imshow(render(solution, camera=CORNER), interpolation="antialiased")
        left.set_title("room")
        left.axis("off")
        _maze(figure, right)
        return _save(figure, path)


def sample_lines(path: Path) -> list[Path]:
    """Draw figure 1: local lines of one patch of the room, and global lines through all of it."""
    import matplotlib

    room = load_scene("room")
    with matplotlib.rc_context(STYLE):
        figure = _figure(9.2, 5.1)
        left, right = figure.subplots(1, 2)
        for panel, title in ((left, "local lines of one patch"), (right, "global lines")):
            _room(panel, room, title)
        _local(left, room)
        _global(right, room)
        for panel in (left, right):
            panel.set(xlim=right.get_xlim(), ylim=right.get_ylim())
        return _save(figure, path)


def orders(path: Path) -> list[Path]:
    """Draw figure 2: the same lines, numbered in the order in which they are fired."""
    import matplotlib

    room = load_scene("room")
    paths = walks(room, _light(room), PARTICLES, WALKS_SEED)
    lengths = [len(points) - 1 for points in paths]
    with matplotlib.rc_context(STYLE):
        figure = _figure(6.4, 8.6)
        above, below = figure.subplots(2, 1)
        _numbered(above, room, paths, breadth_first(lengths), "breadth-first: wavefront by wavefront", "wavefront", 1)
        _numbered(below, room, paths, depth_first(lengths), "depth-first: particle by particle", "particle", 0)
        return _save(figure, path)


def _maze(figure, panel) -> None:
    from matplotlib.collections import LineCollection, PolyCollection

    patches = subdivide(load_scene(MAZE), cells=1)
    floor, wall = patches.normal[:, 2] > 0.5, np.abs(patches.normal[:, 2]) < 0.5
    feet = patches.corners[wall][:, :, :2]
    low, high = feet.min(axis=1), feet.max(axis=1)
    inner = patches.normal[wall][:, :2] * THICK
    sides = np.stack([low, high, high + inner, low + inner], axis=1)
    value = patches.reflectance[:, 0]
    shown = floor | wall
    limits = (np.floor(value[shown].min() * 20) / 20, np.ceil(value[shown].max() * 20) / 20)
    for shapes, values, edge in (
        (patches.corners[floor][:, :, :2], value[floor], ("0.5", 0.3)),
        (sides, value[wall], (BLUE, 0.6)),
    ):
        drawn = PolyCollection(list(shapes), array=values, cmap="gray", clim=limits, edgecolors=edge[0], linewidths=edge[1])
        panel.add_collection(drawn)
    panel.add_collection(LineCollection(list(np.stack([low, high], axis=1)), colors=BLUE, linewidths=2.2))
    bar = figure.colorbar(drawn, ax=panel, shrink=0.85, ticks=np.arange(limits[0], limits[1] + 0.01, 0.05), format="%.2f")
    bar.set_label("reflectance")
    panel.set(title=f"{MAZE} from above: floor, sides of walls", aspect="equal")
    panel.autoscale_view()
    panel.axis("off")


def _local(panel, room: Scene) -> None:
    patches = subdivide(room, cells=6)
    patch = int(np.linalg.norm(patches.centroid - PATCH_AT, axis=1).argmin())
    panel.fill(*_project(patches.corners[patch]).T, color=ORANGE, alpha=0.6, linewidth=0, zorder=3)
    lines = local_lines(patches, patch, LOCAL, LOCAL_SEED)
    for start, end in lines:
        _segment(panel, room, start, end, color=BLUE, linewidth=1.1)
        _dots(panel, end[None], BLUE)
    _dots(panel, lines[:, 0], ORANGE)
    _legend(panel, [("patch", ORANGE, 6.0), ("line to the nearest hit", BLUE, 1.4)])


def _global(panel, room: Scene) -> None:
    from matplotlib.patches import Circle

    centre, radius = sphere(room)
    panel.add_patch(Circle(tuple(_project(centre)), radius, fill=False, edgecolor="0.75", linestyle=":", linewidth=0.9))
    lines = chords(room, CHORDS, CHORDS_SEED)
    for line in lines:
        panel.plot(*_project(line).T, color="0.6", linewidth=0.8, zorder=3)
        _dots(panel, line, "0.6")
    for ends in spans(room, lines).ends:
        _segment(panel, room, *ends, color=BLUE, linewidth=1.6)
        _dots(panel, ends, BLUE)
    panel.set(xlim=_around(panel, centre, radius, 0), ylim=_around(panel, centre, radius, 1))
    _legend(panel, [("span, whose ends see each other", BLUE, 1.8), ("rest of the chord", "0.6", 1.0)])


def _around(panel, centre, radius: float, axis: int) -> tuple[float, float]:
    middle = _project(centre)[axis]
    return middle - 1.03 * radius, middle + 1.03 * radius


def _numbered(panel, room: Scene, paths, order, title: str, group: str, which: int) -> None:
    """Draw path segments with their numbers; those fired together share a colour: ``which`` of (walk, segment) they share."""
    _room(panel, room, title)
    for number, fired in enumerate(order, start=1):
        start, end = paths[fired[0]][fired[1] : fired[1] + 2]
        colour = COLOURS[fired[which] % len(COLOURS)]
        _segment(panel, room, start, end, color=colour, linewidth=1.4)
        tip = _project(np.stack([start, end]))
        arrow = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0, "linewidth": 0, "mutation_scale": 11}
        panel.annotate("", tip[1], tip[1] - 1e-2 * (tip[1] - tip[0]), arrowprops=arrow, zorder=5)
        badge = {"boxstyle": "circle,pad=0.18", "facecolor": "white", "edgecolor": colour, "linewidth": 1.1}
        panel.text(
            *(0.5 * tip[0] + 0.5 * tip[1]),
            str(number),
            ha="center",
            va="center",
            color="black",
            bbox=badge,
            fontsize=8.5,
            zorder=6,
        )
    _dots(panel, np.array([points[0] for points in paths]), "black")
    groups = sorted({fired[which] for fired in order})
    _legend(panel, [(f"{group} {k + 1}", COLOURS[k % len(COLOURS)], 1.6) for k in groups], columns=4)


def _room(panel, room: Scene, title: str) -> None:
    """Draw a room: faces that the viewer sees from the front are filled; the others have edges only."""
    toward = _axes()[2]
    corner, first, second = room.frames
    corners = np.stack([corner, corner + first, corner + first + second, corner + second], axis=1)
    facing = room.normal @ toward > 0
    names = np.array(room.names)[room.surface]
    boxes = np.char.endswith(names, "box")
    for face in np.argsort(corners.mean(axis=1) @ toward):
        outline = _project(corners[face][[0, 1, 2, 3, 0]])
        if names[face] == "light":
            panel.fill(*outline.T, facecolor="#f0e442", edgecolor="0.5", linewidth=0.7, zorder=2)
        elif facing[face]:
            grey = str(0.88 + 0.1 * room.normal[face, 2]) if boxes[face] else "0.975"
            panel.fill(*outline.T, facecolor=grey, edgecolor="0.75", linewidth=0.7, zorder=1 + boxes[face] / 2)
        elif not boxes[face]:
            panel.plot(*outline.T, color="0.8", linewidth=0.7, zorder=1)
    panel.set(aspect="equal", title=title)
    panel.axis("off")


def _segment(panel, room: Scene, start, end, **style: Any) -> None:
    """Draw a segment, faint where a face that the viewer sees lies in front of it."""
    toward = _axes()[2]
    points = start + np.linspace(0, 1, 241)[:, None] * (end - start)
    middle = (points[1:] + points[:-1]) / 2
    t = crossings(room, middle, np.broadcast_to(toward, middle.shape))
    hidden = (np.isfinite(t) & (t > 1e-6) & (room.normal @ toward > 0)).any(axis=1)
    cuts = np.concatenate([[0], np.flatnonzero(np.diff(hidden)) + 1, [len(hidden)]])
    for a, b in pairwise(cuts):
        look = {"alpha": 0.3} if hidden[a] else {}
        panel.plot(*_project(points[[a, b]]).T, solid_capstyle="butt", zorder=4, **style, **look)


def _dots(panel, points: np.ndarray, colour: str) -> None:
    panel.plot(*_project(points).T, linestyle="", marker="o", markersize=2.6, color=colour, zorder=5)


def _legend(panel, entries, columns: int = 2) -> None:
    from matplotlib.lines import Line2D

    handles = [Line2D([], [], color=colour, linewidth=width, label=label) for label, colour, width in entries]
    panel.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.02), ncols=columns, fontsize=9)


def _axes() -> np.ndarray:
    """Return unit vectors as rows: right, up, and towards the viewer, who looks from far away."""
    into = np.array([-np.sin(TURN) * np.cos(TILT), np.cos(TURN) * np.cos(TILT), -np.sin(TILT)])
    right = np.array([np.cos(TURN), np.sin(TURN), 0.0])
    return np.stack([right, np.cross(right, into), -into])


def _project(points: np.ndarray) -> np.ndarray:
    """Return coordinates in the drawing, (..., 2), metres."""
    return points @ _axes()[:2].T


def _light(room: Scene) -> int:
    return int(room.emission[:, 0].argmax())


def _figure(width: float, height: float):
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def _save(figure, path: Path) -> list[Path]:
    png, svg = path.with_suffix(".png"), path.with_suffix(".svg")
    figure.savefig(png, dpi=130)
    figure.savefig(svg, metadata={"Date": None})
    return [png, svg]
