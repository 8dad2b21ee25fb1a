"""Hostile geometry: an answer within its stated error, or one clear sentence."""

import os
import signal
import subprocess
import sys
import time
import warnings
from itertools import pairwise

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import main
from radiosity.diagnostics.check import check
from radiosity.scene.shapes import box, join

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
FAR = 6  # standard errors of 8 replicates: beyond it by chance in one patch of 2000 (t, 7 degrees of freedom)


def furnace(reflectance=0.5, emission=1.0, *, scale=1.0, at=(0.0, 0.0, 0.0), inward=True) -> rd.Scene:
    """A closed cube where B = E / (1 - rho) everywhere."""
    low = np.array(at)
    names = ("south", "north", "west", "east", "floor", "ceiling")
    faces = box(low, low + scale, inward=inward)
    return join([(name, reflectance, emission, [face]) for name, face in zip(names, faces, strict=True)], source="furnace")


def with_more(vertices, faces, reflectance=0.0, emission=0.0, scene=None, **more) -> rd.Scene:
    """The furnace and other faces in or around it, as a surface called "other"."""
    scene = scene or furnace()
    faces = np.asarray(faces)
    if faces.shape[1] == 3:
        faces = np.column_stack([faces, np.full(len(faces), -1)])
    n, own = len(faces), np.ones(scene.n_faces)
    return rd.Scene.from_arrays(
        np.concatenate([scene.vertices, vertices]),
        np.concatenate([scene.faces, np.where(faces >= 0, faces + len(scene.vertices), -1)]),
        np.concatenate([0.5 * own, np.full(n, reflectance)]),
        np.concatenate([own, np.full(n, emission)]),
        surface=np.concatenate([scene.surface, np.full(n, 6)]),
        names=[*scene.names, "other"],
        **more,
    )


def solved(scene, cells=2, rays=40_000, **choices) -> rd.Solution:
    return rd.solve(rd.subdivide(scene, cells=cells), rays=rays, replicates=8, **({"method": "random-walk"} | choices))


def holds(solution, truth, rows: slice | np.ndarray = slice(None)) -> None:
    """Every patch lies within its stated error, which is no empty claim, of the truth."""
    error = solution.standard_error[rows]
    assert (solution.arrivals[rows] > 0).all()
    assert (error > 0).all()
    assert (error < 0.05 * truth).all()
    assert (np.abs(solution.radiosity[rows] - truth) <= FAR * error).all()


@pytest.mark.parametrize("at", [0.0, 1e9], ids=["here", "1e9 away"])
@pytest.mark.parametrize("scale", [1.0, 1e-18, 1e17], ids=["1 m", "1e-18 m", "1e17 m"])
def test_size_and_place(scale, at):
    if at and scale < 1:
        with pytest.raises(rd.SceneError, match="no face is left: all 6 have no area"):
            solved(furnace(scale=scale, at=(at, at, at)))
    else:
        holds(solved(furnace(scale=scale, at=(at, -at, at))), 2)


@pytest.mark.parametrize("large", [1e6, 1e9, 1e12])
def test_details_of_1_m_in_the_middle_of_a_scene_of(large):
    """Embree divides by areas: a cube of a billionth of a scene had its light on the wrong patches."""
    plate = SQUARE * 2 * large - [0, 0, 1]
    scene = with_more(plate, [[0, 1, 2, 3]], scene=furnace(at=(large, large, 0)))
    holds(solved(scene), 2, slice(0, 24))


def test_details_of_1_m_at_the_rim_of_a_scene_of_1e9_are_left_out_aloud():
    plate = SQUARE * 2e9 - [0, 0, 1]
    with pytest.warns(rd.RadiosityWarning, match="6 faces without area left out .*6 of them should emit light"):
        scene = with_more(plate, [[0, 1, 2, 3]])
    with pytest.raises(rd.SceneError, match="no surface emits"):
        solved(scene)


def test_faces_too_small_for_lines_are_left_out_aloud():
    with pytest.warns(rd.RadiosityWarning, match="6 faces without area left out"):
        with_more(SQUARE * 2e15 - [1e15, 1e15, 1], [[0, 1, 2, 3]])


def test_slivers_of_1e_12():
    """Each side of the cube has a strip of 1e-12 m; without the strips it is as good as closed."""
    ends = np.array([0, 0.3, 0.3 + 1e-12, 0.6, 1])
    origin, first, second = furnace().frames
    vertices, faces = [], []
    for side in range(6):
        for low, high in pairwise(ends):
            faces.append(len(vertices) + np.arange(4))
            start, end = origin[side] + low * first[side], origin[side] + high * first[side]
            vertices += [start, end, end + second[side], start + second[side]]
    with pytest.warns(rd.RadiosityWarning, match="6 faces without area left out"):
        scene = rd.Scene.from_arrays(vertices, faces, 0.5, 1.0)
    assert scene.n_faces == 18
    holds(solved(scene, cells=1), 2)


def test_edges_of_no_length():
    with pytest.warns(rd.RadiosityWarning, match="2 faces without area left out"):
        scene = with_more(np.concatenate([SQUARE, SQUARE[:1]]), [[0, 4, 1, -1], [3, 3, 3, -1]])
    holds(solved(scene), 2)
    with pytest.raises(rd.SceneError, match="all 1 have no area"):
        rd.Scene.from_arrays(SQUARE[:1].repeat(3, axis=0), [[0, 1, 2]], 0.5, 1.0)


LONELY = {
    "one triangle": lambda: rd.Scene.from_arrays(SQUARE[:3], [[0, 1, 2]], 0.5, 1.0),
    "a plane": lambda: rd.Scene.from_arrays(
        (SQUARE + np.arange(100)[:, None, None] // (1, 10, 100) % (10, 10, 1) * [1.0, 1, 0]).reshape(-1, 3),
        np.arange(400).reshape(100, 4),
        0.5,
        1.0,
    ),
    "inside out": lambda: furnace(inward=False),
}


@pytest.mark.parametrize("name", LONELY)
def test_nothing_sees_anything(name):
    scene = LONELY[name]()
    solution = solved(scene)
    assert (solution.radiosity == 1).all()
    assert (solution.arrivals == 0).all()
    (book,) = solution.books
    assert book["closes"]
    assert book["escaped"] > 0
    assert book["escaped"] == pytest.approx(book["emitted"] + book["rounding"], rel=1e-12)
    assert "no line hit a patch" in solution.report()
    assert {finding.kind for finding in check(scene).findings if finding.severity == "error"} == {"leaks"}


def test_no_light():
    with pytest.raises(rd.SceneError, match="no surface emits"):
        solved(furnace(emission=0.0))


@pytest.mark.filterwarnings("ignore:40000 lines give each")  # as many as patches
@pytest.mark.parametrize("count", [10_000, pytest.param(1_000_000, marks=pytest.mark.slow)])
def test_coincident_triangles(count):
    """Copies of a black triangle that does not emit take what one of them takes, together."""
    triangle = 0.5 * SQUARE[:3] + [0.2, 0.2, 0.5]
    one = with_more(triangle, [[0, 1, 2]], two_sided=np.arange(7) == 6)
    many = with_more(triangle, np.tile([0, 1, 2], (count, 1)), two_sided=np.arange(6 + count) >= 6)
    first, second = (rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=40_000, replicates=8) for scene in (one, many))
    walls = slice(0, 6)
    apart = np.abs(first.radiosity[walls] - second.radiosity[walls])
    assert (apart <= FAR * np.hypot(first.standard_error[walls], second.standard_error[walls])).all()
    taken = [(s.irradiance[:, 0] * s.patches.area)[6:].sum() for s in (first, second)]
    assert taken[1] == pytest.approx(taken[0], rel=0.05)
    (finding,) = [
        f.message for f in check(with_more(triangle, [[0, 1, 2]] * 3, two_sided=True)).findings if f.kind == "duplicates"
    ]
    assert "lie on another face and radiate to the same side" in finding


@pytest.mark.parametrize("n", [5_000, pytest.param(100_000, marks=pytest.mark.slow)])
def test_very_many_surfaces(n):
    """As many small squares in a furnace of 10 m, each a surface; they are a furnace too."""
    place = np.random.Generator(np.random.Philox(5)).random((n, 1, 3)) * 9.9
    walls = furnace(scale=10.0)
    scene = rd.Scene.from_arrays(
        np.concatenate([walls.vertices, (place + 0.001 * SQUARE).reshape(-1, 3)]),
        np.concatenate([walls.faces, len(walls.vertices) + np.arange(4 * n).reshape(n, 4)]),
        0.5,
        1.0,
        surface=np.concatenate([walls.surface, 6 + np.arange(n)]),
        names=[*walls.names, *(f"s{i}" for i in range(n))],
        two_sided=np.arange(n + 6) >= 6,
    )
    solution = solved(scene, cells=1, rays=400_000)
    holds(solution, 2, slice(0, 6))
    unseen = solution.arrivals == 0
    assert unseen.sum() > n
    unseen &= ~solution.sides.dark  # the rest are unknown, which the report tells
    report = solution.report()
    assert f"of which no line reached {unseen.sum()} (their value is unknown)" in report
    assert f"{n + 6} surfaces" in report


def test_what_almost_all_is_reflected_of_loses_by_rounding_and_tells():
    """B is 1000. Power below a quantum that a patch owes at the end is not fired: the books show it as rounding."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        solution = rd.solve(rd.subdivide(furnace(0.999), cells=2), "random-walk", quanta=20, replicates=8)
    (book,) = solution.books
    told = FAR * solution.error + abs(book["rounding"]) / book["emitted"]
    assert told < 0.2
    assert np.abs(solution.radiosity / 1000 - 1).max() <= told + FAR * (solution.standard_error / 1000).max()


SOLVING = """
import sys, warnings
sys.path[:0] = sys.argv[1:]
warnings.simplefilter("ignore")
from test_hostile import furnace
import radiosity as rd
patches = rd.subdivide(furnace(0.999999), cells=2)
rd.solve(rd.subdivide(furnace(0.5), cells=2), "random-walk", rays=1000, device="cpu")  # imports what a run needs
print("ready", flush=True)
try:
    solution = rd.solve(patches, error=0.01, replicates=8, device="cpu")
    print(solution.status)
except KeyboardInterrupt:
    print("interrupted")
"""


def test_reflectance_of_0_999999_can_be_interrupted():
    """A line is reflected a million times: no stage is complete soon."""
    folder = os.path.dirname(__file__)
    process = subprocess.Popen(
        [sys.executable, "-c", SOLVING, folder, os.path.dirname(os.path.dirname(rd.__file__))],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    time.sleep(2)  # whenever it comes, the outcome is the same
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert out.strip() == "interrupted"
    assert err == ""
    assert process.returncode == 0


CUBE_OBJ = "".join(f"v {x} {y} {z}\n" for x in (0, 1) for y in (0, 1) for z in (0, 1)) + "usemtl white\n"
CUBE_OBJ += "f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4\n"  # fronts look outwards
MTL = "newmtl white\nKd {0} {0} {0}\nKe {1} {1} {1}\n"
SOLVE = ("--rays", "20k", "--cells", "1", "-o")


def command(capsys, tmp_path, obj: str, mtl: str, *arguments):
    """Status, and the lines on stderr, of ``radiosity solve`` of an OBJ file."""
    (tmp_path / "scene.obj").write_text("mtllib scene.mtl\n" + obj)
    (tmp_path / "scene.mtl").write_text(mtl)
    status = main(["solve", str(tmp_path / "scene.obj"), *SOLVE, str(tmp_path / "out.npz"), *arguments])
    return status, capsys.readouterr().err.splitlines()


def test_reflectance_of_0_999999_of_a_file_is_brought_down_aloud(capsys, tmp_path):
    status, said = command(capsys, tmp_path, CUBE_OBJ, MTL.format(0.999999, 1))
    assert status == 0
    assert [line for line in said if "warning: " in line and "reflectance above 0.95 brought down to it" in line]
    solution = rd.load_solution(tmp_path / "out.npz")
    holds(solution, solution.patches.emission[0, 0] / 0.05, solution.patches.is_back)


REFUSED = {
    "no light": (CUBE_OBJ, MTL.format(0.5, 0), "no surface emits"),
    "coordinates of 1e38": (CUBE_OBJ.replace("v 1 ", "v 1e38 "), MTL.format(0.5, 1), "coordinates reach 1e+38 m; check the unit"),
    "coordinates of 1e400": (CUBE_OBJ.replace("v 1 ", "v 1e400 "), MTL.format(0.5, 1), "finite"),
    "nothing with an area": (
        "v 0 0 0\nv 1 0 0\nv 2 0 0\nusemtl white\nf 1 2 3\n",
        MTL.format(0.5, 1),
        "no face is left: all 1 have",
    ),
    "an emission of 1e300": (CUBE_OBJ, MTL.format(0.5, 1e300), "below 1e+30"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused_in_one_line(capsys, tmp_path, name):
    obj, mtl, text = REFUSED[name]
    status, said = command(capsys, tmp_path, obj, mtl)
    assert status == 2
    (line,) = said
    assert line.startswith("radiosity: error: ")
    assert text in line
    assert not (tmp_path / "out.npz").exists()


def test_a_face_of_ten_thousand_corners(capsys, tmp_path):
    """A disc over a floor: cut into triangles whose areas sum to the polygon's."""
    n = 10_000
    angle = 2 * np.pi * np.arange(n) / n
    rim = "".join(f"v {x:.9f} {y:.9f} 1\n" for x, y in zip(np.cos(angle), np.sin(angle), strict=True))
    obj = f"{rim}o disc\nusemtl white\nf {' '.join(map(str, range(n, 0, -1)))}\n"  # the front looks down
    obj += "v -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\no floor\nusemtl white\nf -4 -3 -2 -1\n"
    status, said = command(capsys, tmp_path, obj, MTL.format(0.5, 1))
    assert status == 0
    assert not [line for line in said if not line.startswith("radiosity: warning: ")]
    scene = rd.load_solution(tmp_path / "out.npz").patches.scene
    disc = scene.surface == scene.names.index("disc/white")
    (lost,) = [int(line.split("scene.obj: ")[1].split()[0]) for line in said if "without area left out" in line]
    assert disc.sum() == n - 2 - lost
    assert lost < 20
    assert scene.area[disc].sum() == pytest.approx(n / 2 * np.sin(2 * np.pi / n), rel=1e-6)
