"""Scenes that other programs are asked about too. Lamps are black where a program's lamps are."""

from dataclasses import replace

import numpy as np

import radiosity as rd

from .shapes import quad


def court() -> rd.Scene:
    """An open court in three colours: a floor, two walls that meet, a pyramid of triangles, a table seen from both sides, and a
    black lamp panel above; the sky is black."""
    white, red, blue = (0.7, 0.7, 0.7), (0.7, 0.2, 0.1), (0.15, 0.3, 0.65)
    top = np.array([1.0, 1.2, 1.1])
    base = np.array([(0.5, 0.6, 0), (1.6, 0.7, 0), (1.5, 1.8, 0), (0.4, 1.7, 0)])
    pyramid = [np.array([base[i], base[(i + 1) % 4], top, top]) for i in range(4)]
    parts = [
        ("floor", white, 0, [quad((0, 0, 0), (4, 0, 0), (0, 3, 0))]),
        ("west wall", red, 0, [quad((0, 0, 0), (0, 3, 0), (0, 0, 2))]),
        ("south wall", blue, 0, [quad((0, 0, 0), (0, 0, 2), (4, 0, 0))]),
        ("pyramid", (0.5, 0.6, 0.4), 0, pyramid),
        ("table", (0.6, 0.5, 0.3), 0, [quad((2.4, 1.2, 0.7), (1.0, 0.3, 0), (-0.2, 0.9, 0))]),
        ("lamp", (0, 0, 0), (30, 28, 20), [quad((1.6, 1.0, 2.2), (0, 0.8, 0), (0.8, 0, 0))]),
    ]
    rows = [(i, *part[1:3], corners) for i, part in enumerate(parts) for corners in part[3]]
    faces = np.arange(4 * len(rows)).reshape(-1, 4)
    faces[[i == 3 for i, *_ in rows], 3] = -1
    return rd.Scene.from_arrays(
        np.concatenate([corners for *_, corners in rows]),
        faces,
        np.array([np.broadcast_to(r, 3) for _, r, _, _ in rows], float),
        np.array([np.broadcast_to(e, 3) for _, _, e, _ in rows], float),
        surface=[i for i, *_ in rows],
        two_sided=[parts[i][0] == "table" for i, *_ in rows],
        names=[name for name, *_ in parts],
        source="court",
    )


def veiled() -> rd.Scene:
    """The court with two diffusing sheets in colour: an opal cover under the lamp, and a leaning one by the table."""
    scene, opal = court(), np.array([0.25, 0.2, 0.1])
    sheets = [quad((1.3, 0.7, 1.8), (1.4, 0, 0), (0, 1.4, 0)), quad((2.0, 1.1, 0.1), (0.2, 0, 1.2), (0, 1.5, 0.1))]
    none = np.zeros((scene.n_faces, 3))
    return rd.Scene.from_arrays(
        np.concatenate([scene.vertices, *sheets]),
        np.concatenate([scene.faces, len(scene.vertices) + np.arange(8).reshape(2, 4)]),
        np.concatenate([scene.reflectance, [opal, opal]]),
        np.concatenate([scene.emission, np.zeros((2, 3))]),
        surface=np.append(scene.surface, [len(scene.names)] * 2),
        back=np.append(scene.back, [rd.Back.RADIATES] * 2),
        diffuse_transmittance=np.concatenate([none, [2 * opal, 2 * opal]]),
        names=[*scene.names, "veil"],
        source="veiled court",
    )


def with_black_lamps(scene: rd.Scene) -> rd.Scene:
    """Lamps that reflect nothing on either side, as Radiance's do."""
    lamp = (scene.emission > 0).any(axis=1)
    back = np.where(lamp, np.uint8(rd.Back.ABSORBS), scene.back).astype(scene.back.dtype)
    return replace(scene, reflectance=np.where(lamp[:, None], 0.0, scene.reflectance), back=back)


def parallel_scenes() -> list[tuple[str, rd.Patches]]:
    """Scenes for Mitsuba, in patches."""
    cut = {"room": 4, "cornell-box": 3, "labyrinth-0.9": 2}
    return [
        *((name, rd.subdivide(rd.load_scene(name), cells=k)) for name, k in cut.items()),
        ("court", rd.subdivide(court(), cells=4)),
    ]


def radiance_scenes() -> list[tuple[str, rd.Patches]]:
    """Scenes for Radiance, in patches."""
    found = [
        (f"{name}, black lamp", rd.subdivide(with_black_lamps(rd.load_scene(name)), cells=k))
        for name, k in (("room", 4), ("cornell-box", 3))
    ]
    return [
        *found,
        ("labyrinth-0.9", rd.subdivide(rd.load_scene("labyrinth-0.9"), cells=2)),
        ("court", rd.subdivide(court(), cells=4)),
        ("veiled court", rd.subdivide(veiled(), cells=4)),
    ]
