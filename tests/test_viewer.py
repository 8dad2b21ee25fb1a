"""The viewer without a browser: colours, meshes, picking, and who may connect."""

import json
import struct
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.image import display_mesh, tone
from radiosity.image.plane_fit import at_vertices
from radiosity.image.quantity import Quantity
from radiosity.scene import Back
from radiosity.solution import intervals
from radiosity.viewer import about, numbers, tone_mapping
from radiosity.viewer.content import Content
from radiosity.viewer.frame import Frame, options
from radiosity.viewer.look import Look
from radiosity.viewer.mesh import Shapes, Triangles
from radiosity.viewer.picking import Cut, pick
from radiosity.viewer.refinement import DIFFERENCE, refined
from radiosity.viewer.server import allowed, require
from radiosity.viewer.shades import Colours, Shades
from radiosity.viewer.subject import Subject


@pytest.fixture(scope="module")
def solution():
    return rd.solve(rd.subdivide(rd.load_scene("room"), cells=3), "random-walk", rays=50_000, replicates=2)


def test_the_inverse_of_the_tone_mapping_gives_every_colour():
    cube = np.stack(np.meshgrid(*[np.linspace(0, 1, 9)] * 3), axis=-1).reshape(-1, 3)
    np.testing.assert_allclose(tone_mapping.after(tone_mapping.before(cube)), cube, atol=1e-12)


def parsed(data: bytes) -> tuple[np.ndarray, np.ndarray, np.ndarray, dict]:
    """Return positions, colours and elements of a GLB file of the viewer, and its document."""
    length = struct.unpack("<I", data[12:16])[0]
    contents, body = json.loads(data[20 : 20 + length]), data[28 + length :]
    views = contents["bufferViews"]
    parts = [body[v["byteOffset"] : v["byteOffset"] + v["byteLength"]] for v in views]
    width = 3 if contents["meshes"][0]["primitives"][0]["mode"] == 4 else 2
    elements = np.frombuffer(parts[2], "<u4").reshape(-1, width)
    return *(np.frombuffer(part, "<f4").reshape(-1, 3) for part in parts[:2]), elements, contents


def test_each_patch_has_the_colour_of_the_legend(solution):
    content = Content.of(Subject.of(solution))
    look = Look("irradiance", smooth=False, shades=Shades(false=True, limits=(0.0, 0.4)))
    colours = content.colours(look)
    nodes = dict(content.meshes(look, colours))
    assert len(nodes) == len(solution.patches.scene.names)
    wanted = {tuple(row) for row in tone.eight_bits(colours.palette(solution.irradiance[:, 0]))}
    shown = set()
    for data in nodes.values():
        points, given, elements, _ = parsed(data)
        colour = tone.eight_bits(tone.srgb(tone_mapping.after(given.astype(np.float64))))
        assert (colour[elements] == colour[elements[:, :1]]).all()
        shown |= {tuple(row) for row in colour}
        assert (points >= solution.patches.scene.bounds[0] - 1e-5).all()
    assert shown == wanted


def test_the_page_smooths_as_files_do():
    """A square of two triangles: its corners have fits to the plane, which vertices alone do not give."""
    corners = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 2, 0]]
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2], [0, 2, 3]], reflectance=0.5, emission=1.0, names=["wall"])
    subject = Subject.of(rd.solve(rd.subdivide(scene, cells=3), "random-walk", rays=1000, replicates=2))
    shown = replace(subject.quantity("radiosity"), values=subject.patches.centroid[:, :1] ** 2)
    mesh = display_mesh.build(subject.patches)
    values = Shapes(subject).triangles("radiosity", shown, None, smooth=True).values
    np.testing.assert_array_equal(values, at_vertices(subject.patches, mesh, shown.values))
    assert np.abs(values - mesh.smoothed(shown.values)).max() > 0.01


def test_a_cut_keeps_the_area_on_its_side_and_the_values(solution):
    subject = Subject.of(solution)
    whole = Shapes(subject).triangles("radiosity", subject.quantity("radiosity"), None, smooth=False)
    low, high = solution.patches.scene.bounds[:, 0]
    at = low + 0.37 * (high - low)
    parts = [whole.cut(Cut(0, at, below)) for below in (False, True)]
    assert parts[0].vertices[:, 0].max() <= at + 1e-12
    assert parts[1].vertices[:, 0].min() >= at - 1e-12
    assert sum(areas(part).sum() for part in parts) == pytest.approx(areas(whole).sum(), rel=1e-12)
    for part in parts:
        np.testing.assert_allclose(part.values[part.corners][:, :, 0], solution.radiosity[part.patch].repeat(3, 1), rtol=1e-12)
        normal = np.cross(*(part.vertices[part.corners[:, k]] - part.vertices[part.corners[:, 0]] for k in (1, 2)))
        assert (np.einsum("ij,ij->i", normal, solution.patches.normal[part.patch]) >= 0).all()


def areas(part: Triangles) -> np.ndarray:
    a, b, c = (part.vertices[part.corners[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_smooth_colours_are_right_between_corners():
    """Across a triangle from dark to bright; a mesh that is not refined is off by a tenth of the range."""
    corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    plain = Triangles(corner, np.array([[0.0], [0.5], [1.0]]), np.array([[0, 1, 2]]), np.array([4]))

    def linear(values):
        return np.clip(tone.colours(values), 0, 1)

    def worst(mesh):
        given = tone_mapping.before(linear(mesh.values))
        weights = np.random.default_rng(5).dirichlet([1, 1, 1], 50)
        shown = tone_mapping.after(np.einsum("wk,mkc->mwc", weights, given[mesh.corners]))
        meant = linear(np.einsum("wk,mkc->mwc", weights, mesh.values[mesh.corners]))
        return np.abs(tone.srgb(shown) - tone.srgb(meant)).max()

    fine = refined(plain, linear)
    assert worst(plain) > 0.1
    assert worst(fine) < 2 * DIFFERENCE
    assert areas(fine).sum() == pytest.approx(0.5)
    assert (fine.patch == 4).all()
    edges = np.sort(fine.corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    _, count = np.unique(edges, axis=0, return_counts=True)
    rim = sum(np.ptp(fine.vertices[np.unique(edges, axis=0)][:, :, axis], axis=1) == 0 for axis in (0, 1))
    assert set(count) == {1, 2}, "no edge ends within another"
    assert rim.any()


def test_a_ray_meets_what_the_page_shows():
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    scene = rd.Scene.from_arrays(
        corners, [[0, 1, 2, 3], [4, 5, 6, 7]], reflectance=0.5, emission=1, surface=[0, 1], names=["low", "high"]
    )
    patches, shown = rd.subdivide(scene, cells=2), np.zeros(2, bool)
    down = ([0.7, 0.2, 5.0], [0, 0, -1])
    patch, point = pick(patches, *down, shown)
    assert scene.names[patches.surface[patch]] == "high"
    np.testing.assert_allclose(point, [0.7, 0.2, 1])
    assert np.abs(patches.centroid[patch] - [0.75, 0.25, 1]).max() < 1e-12
    hidden, cut = pick(patches, *down, np.array([False, True])), pick(patches, *down, shown, Cut(2, 0.5))
    assert hidden[0] == cut[0]
    assert patches.centroid[cut[0]].tolist() == [0.75, 0.25, 0]
    assert pick(patches, [0.7, 0.2, -5], [0, 0, 1], shown) is None, "backs that do not radiate are not shown"
    assert pick(patches, [1.7, 0.2, 5], [0, 0, -1], shown) is None


def test_numbers_of_a_patch(solution):
    text = numbers.told(Subject.of(solution), 7, [1, 2, 3])
    low, high = (end[7, 0] for end in solution.interval())
    assert f"{solution.radiosity[7, 0]:.4g} W/m² ({low:.4g} to {high:.4g})" in text
    assert "south wall" in text
    assert "not solved yet" in numbers.told(Subject(solution.patches), 7, [1, 2, 3])


@pytest.mark.parametrize("diffuse", [False, True])
def test_a_click_finds_the_interval_of_its_patch_alone(monkeypatch, diffuse):
    """The same bits as among all patches, also where light comes through from the other side."""
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]
    pane = {"diffuse_transmittance": np.array([0.4, 0.0]), "back": np.array([Back.RADIATES, Back.ABSORBS])} if diffuse else {}
    emission = np.array([0.0, 5.0])
    scene = rd.Scene.from_arrays(corners, np.arange(8).reshape(2, 4), reflectance=0.3, emission=emission, **pane)
    solution = rd.solve(rd.subdivide(scene, cells=6), "random-walk", quanta=250, replicates=2)
    wanted = {name: solution.interval(0.95, name) for name in ("radiosity", "irradiance")}
    assert solution.few.any()
    counted, bounds = [], intervals.count_bounds
    monkeypatch.setattr(intervals, "count_bounds", lambda count, *rest: counted.append(count.size) or bounds(count, *rest))
    subject = Subject.of(solution)
    for patch in range(0, len(solution.patches), 5):
        for name, ends in subject.interval(patch).items():
            np.testing.assert_array_equal(ends, [end[patch] for end in wanted[name]])
    assert set(counted) == {1}


def test_small_bright_patches_set_no_range_of_the_page():
    quantity = Quantity(np.append(np.full(50, 500.0), 2.0)[:, None], "light", "lx", ("all",), np.zeros(51, bool))
    colours = Colours.of(Shades(false=True), quantity, np.append(np.full(50, 1e-5), 1.0))
    assert colours.palette is not None
    assert colours.palette.high == 2


def test_names_of_a_file_are_no_markup():
    assert numbers.plain("<img src=x onerror=alert(1)>*_`") == "\\<img src=x onerror=alert\\(1\\)\\>\\*\\_\\`"


def test_a_scene_that_is_not_solved_offers_nothing_false():
    scene = rd.load_scene("cornell-box")
    subject = Subject.of(rd.subdivide(scene, cells=1))
    assert list(subject.names) == ["reflectance", "emission"]
    with pytest.raises(rd.OutputError, match=r"no quantity 'radiosity' before the scene is solved.*reflectance, emission"):
        subject.quantity("radiosity")
    np.testing.assert_array_equal(subject.quantity("reflectance", "green").values[:, 0], subject.patches.reflectance[:, 1])
    assert "not solved yet" in about.text(subject, rd.check(scene).findings)
    with pytest.raises(rd.MethodError, match="view takes a Solution"):
        Subject.of("room.npz")


def test_the_hits_are_shown_where_they_were_counted(solution):
    subject = Subject.of(solution)
    np.testing.assert_array_equal(subject.quantity("arrivals").values[:, 0], solution.arrivals)
    gathered = rd.solve(solution.patches, "gather", rays=20_000)
    assert "arrivals" not in Subject.of(gathered).names
    assert "luminance" not in subject.names
    with pytest.raises(rd.OutputError, match="band 'red' does not exist; known are grey"):
        subject.quantity("arrivals", "red")


def test_far_and_small_scenes_are_brought_near():
    corners = np.array([[0, 0, 0], [1e-3, 0, 0], [1e-3, 1e-3, 0], [0, 1e-3, 0]]) + np.array([5e3, 2e3, 0])
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], reflectance=0.5, emission=1)
    frame = Frame.of(scene)
    shown = frame.to_page(corners).astype(np.float32).astype(float)
    np.testing.assert_allclose(np.ptp(shown, axis=0), [10, 10, 0], rtol=1e-6)
    np.testing.assert_allclose(frame.to_scene(frame.to_page(corners)), corners, atol=1e-9)
    room = Frame.of(rd.load_scene("room"))
    assert (room.scale, room.origin.tolist()) == (1.0, [0, 0, 0])


def test_the_camera_is_one_that_render_takes():
    frame = Frame(np.array([100.0, 0, 0]), 10.0)
    camera = frame.camera([0, 10, 5], [10, 10, 5], [0, 0, 1], np.pi / 4, 640, 480)
    assert camera == rd.Camera((100.0, 1.0, 0.5), (101.0, 1.0, 0.5), (0.0, 0.0, 1.0), 45.0, 640, 480)
    assert options(camera) == "--origin 100,1,0.5 --target 101,1,0.5 --up 0,0,1 --fov 45 --width 640 --height 480"


@pytest.mark.parametrize(
    ("origin", "asked", "host", "may"),
    [
        (None, "localhost:8080", "localhost", True),
        ("http://localhost:8080", "localhost:8080", "localhost", True),
        ("http://127.0.0.1:9000", "127.0.0.1:9000", "localhost", True),
        ("https://elsewhere.org", "localhost:8080", "localhost", False),
        ("http://localhost:3000", "localhost:8080", "localhost", False),
        ("http://elsewhere.org:8080", "elsewhere.org:8080", "localhost", False),  # a name that was made to mean this machine
        ("http://office.lan:8080", "office.lan:8080", "0.0.0.0", True),
        ("https://elsewhere.org", "office.lan:8080", "0.0.0.0", False),
    ],
)
def test_pages_of_other_sites_may_not_connect(origin, asked, host, may):
    assert allowed(origin, asked, host) is may


def test_a_missing_library_is_named(monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(rd.OutputError, match=r"the viewer needs 'viser'.*radiosity\[view\]"):
        require()


@pytest.mark.parametrize(
    ("method", "order", "rays", "stages"),
    [
        ("gather", "gather", 3e5, 5),
        ("gather", "gather", 1.5e6, 5),  # unwatched it is one stage, watched a first rung and another stage
        ("random-walk", "staged", 2e4, 9),
        ("stochastic-jacobi", "regular", 1e5, 5),
    ],
)
def test_who_watches_a_run_changes_nothing(method, order, rays, stages):
    """Three bands, by a method whose lines are known beforehand, and by counts: the same bits, whatever the stages."""
    patches, seen = rd.subdivide(rd.load_scene("cornell-box"), cells=1), []
    plain = rd.solve(patches, method, order=order, rays=rays, replicates=1)
    watched = rd.solve(patches, method, order=order, rays=rays, replicates=1, watch=seen.append)
    assert len(seen) == stages
    assert [one.status for one in seen] == ["running"] * len(seen)
    assert [one.rays for one in seen] == sorted({one.rays for one in seen})
    np.testing.assert_array_equal(seen[-1].radiosity, plain.radiosity)
    for name in ("irradiance", "irradiance_standard_error", "arrivals"):
        np.testing.assert_array_equal(getattr(watched, name), getattr(plain, name))
    assert all(np.array_equal(plain.state[key], watched.state[key]) for key in plain.state)
    assert (watched.quanta, watched.status) == (plain.quanta, "complete")


def test_too_many_edges_are_refused(solution, monkeypatch):
    content = Content.of(Subject.of(solution))
    points, _, lines, _ = parsed(content.edges(Look()))
    sides = points[lines]
    assert len(lines) == 4 * len(solution.patches)
    assert np.linalg.norm(sides[:, 0] - sides[:, 1], axis=1).min() > 0.05
    monkeypatch.setattr("radiosity.viewer.content.MOST_EDGED", 10)
    with pytest.raises(rd.OutputError, match=r"patches have too many edges to see; hide surfaces until 10 are left"):
        content.edges(Look())
