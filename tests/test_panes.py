"""Panes: clear faces that let a share of the lines go straight on (contract 17)."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

import radiosity as rd
from radiosity.factors.polygons import exchange
from radiosity.image import gltf, mesh, picture, quantity
from radiosity.image.look import Look
from radiosity.image.lookup import Lookup
from radiosity.scene.back import Back
from radiosity.scene.combine import combine
from radiosity.scene.lights.model import Lights
from radiosity.scene.lights.sun import Sun
from radiosity.scene.quads import merge_triangles

T, RHO = 0.4, 0.25
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
ABOVE = SQUARE[::-1] + np.array([0, 0, 1])


def faces_of(*corners):
    """Return vertices and faces of quadrilaterals."""
    return np.concatenate(corners), np.arange(4 * len(corners)).reshape(-1, 4)


def two_rooms(emission, transmittance=T, **more) -> rd.Scene:
    """A box of 2 x 1 x 1 m with a two-sided pane across its middle, the last face; emission of each of its 11 faces."""
    x, y, z = np.eye(3)
    ends = [[0 * x, y, y + z, z], [2 * x, 2 * x + z, 2 * x + y + z, 2 * x + y]]
    for at in (0 * x, x):
        ends += [[at, at + z, at + x + z, at + x], [at + y, at + x + y, at + x + y + z, at + y + z]]
        ends += [[at, at + x, at + x + y, at + y], [at + z, at + y + z, at + x + y + z, at + x + z]]
    vertices, faces = faces_of(*map(np.array, ends), np.array([x, x + y, x + y + z, x + z]))
    reflectance = np.where(np.arange(11) < 10, 0.5, RHO)
    names = [f"wall {i}" for i in range(10)] + ["pane"]
    sides = np.arange(11) == 10
    through = transmittance * sides
    return rd.Scene.from_arrays(
        vertices, faces, reflectance, emission, surface=range(11), names=names, two_sided=sides, transmittance=through, **more
    )


def glazed(*heights, transmittance=0.5, turn=1, back=Back.RADIATES, emission=None) -> rd.Scene:
    """A black lamp of 1 W/m² under a black square 1 m above it, with larger black panes between them at these heights."""
    size = [SQUARE, ABOVE]
    panes = [(SQUARE - np.array([0.5, 0.5, 0])) * 4 + np.array([0.5, 0.5, height]) for height in heights]
    panes = [corners[::turn] for corners in panes]
    vertices, faces = faces_of(*size, *panes)
    n = len(faces)
    return rd.Scene.from_arrays(
        vertices,
        faces,
        0.0,
        np.arange(n) == 0 if emission is None else emission,
        surface=range(n),
        names=["lamp", "target", *(f"pane {i}" for i in range(n - 2))],
        back=[Back.ABSORBS] * 2 + [back] * (n - 2),
        transmittance=np.where(np.arange(n) < 2, 0, transmittance),
    )


FORM = float(exchange(SQUARE[None], ABOVE[None])[0])  # of two opposite squares


@pytest.mark.parametrize("method", ["random-walk", "gather", "stochastic-jacobi-bidirectional", "progressive-refinement"])
def test_a_closed_box_with_a_pane_is_a_furnace(method):
    """With E = 1 - rho - t everywhere the irradiance is 1, and B = 1 - t on the pane: the rest of 1 comes through it."""
    patches = rd.subdivide(two_rooms(0.5 - 0.15 * (np.arange(11) == 10)), cells=1)
    more = {"rays": 2e5} if method != "progressive-refinement" else {}
    solution = rd.solve(patches, method, seed=3, **more)
    bound = 0.02
    assert solution.irradiance == pytest.approx(np.ones((12, 1)), abs=bound)
    assert solution.radiosity[-2:] == pytest.approx(np.full((2, 1), 1 - T), abs=bound)
    assert solution.books[0]["absorbed"] == pytest.approx(10 * 0.5 + 2 * (1 - RHO - T), rel=5e-3)
    if method == "random-walk":
        assert solution.books[0]["closes"]


def test_methods_agree_where_a_pane_reflects_and_emits():
    """Student intervals of 99.9 % for 12 patches of one box, against exact factors with visible shares of many rays."""
    patches = rd.subdivide(two_rooms(10.0 * (np.arange(11) == 0) + 3.0 * (np.arange(11) == 10)), cells=1)
    exact = rd.solve(patches, "full-matrix", samples=4096)
    links = rd.solve(patches, "hierarchical", samples=4096, epsilon=1e-4)
    assert links.irradiance == pytest.approx(exact.irradiance, rel=0.005)
    for method in ("random-walk", "gather", "stochastic-jacobi-control-variate"):
        solution = rd.solve(patches, method, rays=4e5, seed=5)
        low, high = solution.interval(0.999, "irradiance")
        wide = 0.02 * exact.irradiance  # the visible shares' own error
        assert ((low - wide < exact.irradiance) & (exact.irradiance < high + wide)).all(), method
    lines = rd.trace_lines(patches, rays=4e5, seed=6)
    assert lines.solve().irradiance == pytest.approx(exact.irradiance, rel=0.03)
    assert lines.patches.area[-1] == 1.0


@pytest.mark.parametrize(("heights", "share"), [((0.5,), 0.5), ((0.3, 0.7), 0.25), ((0.5, 0.5), 0.5)])
def test_panes_dim_what_is_behind_them(heights, share):
    """Two panes in a row pass t²; two at one place are one. The bounds are four standard deviations of the binomial law."""
    rays = 200_000
    solution = rd.solve(rd.subdivide(glazed(*heights), cells=1), "random-walk", rays=rays, seed=1)
    expected = FORM * share
    assert solution.irradiance[1, 0] == pytest.approx(expected, abs=4 * np.sqrt(expected / rays))
    assert solution.books[0]["closes"]


def test_a_pane_on_a_wall_is_the_wall():
    """Of a pane and an opaque face at one place a line meets the opaque one, whichever comes first."""
    sides = ((1, Back.RADIATES), (-1, Back.RADIATES), (-1, Back.PASSES))  # -1: fronts look at the lamp
    for through, (turn, back) in itertools.product(([0, 0, 0.5, 0.0], [0, 0, 0.0, 0.5]), sides):
        scene = glazed(0.5, 0.5, transmittance=np.array(through), turn=turn, back=back)
        solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=1e4, seed=1)
        assert solution.irradiance[1, 0] == 0.0


def test_the_fate_of_a_line_is_its_own():
    """Whole numbers are the same in every order and in any stages (contract 2)."""
    patches = rd.subdivide(two_rooms(1.0 * (np.arange(11) == 0)), cells=2)
    one = rd.solve(patches, "random-walk", quanta=4000, seed=2, replicates=2)
    other = rd.solve(patches, "random-walk", order="depth-first", quanta=4000, seed=2, replicates=2)
    some = rd.solve(patches, "random-walk", quanta=1000, seed=2, replicates=2)
    stages = rd.solve(patches, "random-walk", quanta=4000, seed=2, replicates=2, resume=some)
    for solution in (other, stages):
        for name in ("arrivals", "fired"):
            assert (np.asarray(solution.state[name]) == np.asarray(one.state[name])).all(), name


def test_tables_balance():
    """What a pane emits, less what it absorbs, is its net power; what goes through is no part of it."""
    solution = rd.solve(rd.subdivide(two_rooms(1.0 * (np.arange(11) == 0)), cells=1), "random-walk", rays=2e5, seed=2)
    rows = solution.surface_table()
    pane = next(row for row in rows if row["surface"] == "pane" and row["side"] == "back")
    heat = solution.irradiance[11, 0]
    assert pane["area"] == 1.0
    assert pane["irradiance"] == pytest.approx(heat)
    assert pane["radiosity"] == pytest.approx(RHO * heat)
    assert pane["absorbed"] == pytest.approx((1 - RHO - T) * heat)
    assert pane["net"] == pytest.approx(-pane["absorbed"])
    assert pane["net low"] < pane["net"] < pane["net high"]
    assert sum(row["net"] for row in rows) == pytest.approx(0, abs=1e-4)
    low, high = solution.surface_interval(0.95, "radiosity")
    assert low[10, 0] < solution.radiosity[10:, 0].mean() < high[10, 0]


def test_files_keep_panes(tmp_path):
    scene = two_rooms(1.0)
    assert scene.hash != two_rooms(1.0, transmittance=0).hash
    assert scene.hash != two_rooms(1.0, transmittance=0.3).hash
    solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=1e4)
    solution.save(tmp_path / "a.npz")
    again = rd.load_solution(tmp_path / "a.npz")
    assert again.patches.scene.hash == scene.hash
    assert (again.radiosity == solution.radiosity).all()
    assert scene.take(np.arange(10)).transmittance is None
    assert scene.take([10]).transmittance.tolist() == [T]


def test_scenes_without_panes_keep_their_hash():
    square = {"vertices": SQUARE, "faces": [[0, 1, 2, 3]], "reflectance": 0.5, "emission": 1.0}
    plain, clear = rd.Scene.from_arrays(**square), rd.Scene.from_arrays(**square, transmittance=0.0)
    assert plain.hash == clear.hash
    assert plain.geometry_hash == clear.geometry_hash
    assert clear.transmittance is None


@pytest.mark.parametrize(
    ("transmittance", "more", "message"),
    [
        (1.0, {}, r"face 0 \(surface 'glass'\) is 1; .*leave the surface out"),
        (1.2, {}, r"surface 'glass'\) is 1.2; it must lie in \[0, 1\)"),
        (np.nan, {}, "is nan; it must lie"),
        (0.6, {}, "reflectance 0.4 of its front the sum is 1;"),
        (0.5, {"two_sided": True, "back_reflectance": 0.7}, "reflectance 0.7 of its back"),
        ([0.5, 0.5], {}, r"shape \(2,\); expected one number or \(1,\)"),
        (0.5, {"reflectance": 0.0, "back": [Back.OPEN]}, "open, so that all lines pass already"),
    ],
)
def test_bad_panes_are_refused(transmittance, more, message):
    arguments = {"reflectance": 0.4, "emission": 1.0} | more
    with pytest.raises(rd.SceneError, match=message):
        rd.Scene.from_arrays(SQUARE, [[0, 1, 2, 3]], names=["glass"], transmittance=transmittance, **arguments)


def test_methods_that_cannot_are_refused_by_name():
    patches = rd.subdivide(two_rooms(1.0), cells=1)
    for method in ("global-multipath", "transillumination"):
        with pytest.raises(rd.MethodError, match="'pane' let light through"):
            rd.solve(patches, method, rays=1e4)
    with pytest.raises(rd.MethodError, match="lines 'global'"):
        rd.trace_lines(patches, rays=1e4, lines="global")
    with pytest.raises(rd.MethodError, match="let light through"):
        rd.view_factors(patches, rays=1e5, method="polygons")
    with pytest.raises(rd.SceneError, match=r"surface 'pane', band 0.*0\.7, and its transmittance 0\.4"):
        rd.trace_lines(patches, rays=1e4).solve(reflectance={"pane": 0.7})


def test_pictures_see_through_panes():
    """A pane shows its radiosity, and its share of what is behind it; irradiances show what is behind a clear pane."""
    scene = glazed(0.3, 0.7, transmittance=np.array([0, 0, 0.5, 0.6]), emission=[0, 8, 1, 2])
    solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=1e4, seed=1)
    camera = rd.Camera(origin=(0.5, 0.5, 0.1), target=(0.5, 0.5, 1.0), up=(0, 1, 0), fov=5, width=4, height=3)
    shown = quantity.choose(solution)
    shot = picture.take(solution, shown, camera, look=Lookup(solution.patches, shown.values))
    assert shot.values == pytest.approx(np.full((3, 4, 1), 1 + 0.5 * 2 + 0.5 * 0.6 * 8))
    assert shot.cover.min() == 1
    assert shot.own_light.all()
    fallen = quantity.choose(solution, "irradiance")
    behind = picture.take(solution, fallen, camera, look=Lookup(solution.patches, fallen.values))
    assert behind.values == pytest.approx(np.full((3, 4, 1), solution.irradiance[1, 0]))


def test_sensors_see_lamps_and_what_panes_reflect_and_emit():
    """In a furnace with a pane 1 W/m² comes to every point, through the pane and from it."""
    patches = rd.subdivide(two_rooms(0.5 - 0.15 * (np.arange(11) == 10)), cells=1)
    solution = rd.solve(patches, "random-walk", rays=2e5, seed=3)
    found = rd.measure(solution, rd.Sensors.of([[0.5, 0.4, 0.3], [1.2, 0.5, 0.5]], [0, 0, 1]), rays=2e5, seed=1)
    assert found.illuminance == pytest.approx(np.ones((2, 1)), abs=0.01)


def test_meshes_and_checks_show_panes(tmp_path):
    """Panes of a GLB file are blended by 1 - transmittance; the table of `check` says how clear they are."""
    scene = glazed(0.5, transmittance=np.array([0, 0, 0.4]))
    solution = rd.solve(rd.subdivide(scene, cells=1), "random-walk", rays=1e4, seed=1)
    contents, blocks = gltf.document(mesh.coloured(solution, Look()))
    assert [material.get("alphaMode") for material in contents["materials"]] == [None, "BLEND"]
    primitives = {one["name"]: one["primitives"][0] for one in contents["meshes"]}
    assert {name: one["material"] for name, one in primitives.items()} == {"lamp": 0, "target": 0, "pane 0": 1}
    colours = (
        blocks[contents["accessors"][primitives["pane 0"]["attributes"]["COLOR_0"]]["bufferView"]].view("<u2").reshape(-1, 4)
    )
    assert (colours[:, 3] == round(0.6 * 65535)).all()
    assert [surface.sides for surface in rd.check(scene).surfaces] == ["one", "one", "two; a pane, 0.4 clear"]


@pytest.mark.parametrize("method", ["random-walk", "gather"])
def test_the_sun_shines_through_a_pane(method):
    """800 W/m² at 60° through a pane of 0.5: 200 W/m² on the floor, within five standard errors (2 % at most)."""
    corners = [SQUARE, (SQUARE - np.array([0.5, 0.5, 0])) * 4 + np.array([0.5, 0.5, 0.5])]
    vertices, faces = faces_of(*corners)
    scene = rd.Scene.from_arrays(vertices, faces, 0.0, 0.0, surface=range(2), names=["floor", "pane"], transmittance=[0, 0.5])
    sun = Sun("sun", np.array([np.sqrt(0.75), 0, 0.5]), np.array([800.0]), 0.0)
    patches = rd.subdivide(replace(scene, lights=Lights(suns=(sun,))), cells=1)
    rays = 4e5 if method == "random-walk" else 2e4  # lines of the sun begin all over the pane
    solution = rd.solve(patches, method, rays=rays, seed=1)
    found, error = solution.irradiance[0, 0], solution.irradiance_standard_error[0, 0]
    assert found == pytest.approx(200, abs=5 * error)
    assert error < 4


def test_faces_keep_their_own_transmittance():
    """Halves of a square that let unlike shares through stay two faces, and scenes put together keep each face's."""
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]

    def halves(one, two):
        return rd.Scene.from_arrays(corners, [[0, 1, 2], [0, 2, 3]], 0.1, 1.0, transmittance=[one, two])

    assert merge_triangles(halves(0.5, 0.5)).transmittance.tolist() == [0.5]
    assert merge_triangles(halves(0.5, 0.2)).transmittance.tolist() == [0.5, 0.2]
    opaque = rd.Scene.from_arrays(corners, [[0, 1, 2]], 0.1, 1.0)
    both = combine([opaque, halves(0.5, 0.2)], source="both", photometric=False, scale=1.0)
    assert both.transmittance.tolist() == [0.0, 0.5, 0.2]
    assert combine([opaque, opaque], source="both", photometric=False, scale=1.0).transmittance is None
    # a quadrilateral that is no parallelogram becomes two triangles, each with its transmittance
    bent = rd.Scene.from_arrays([*corners[:3], [0, 2, 0]], [[0, 1, 2, 3]], 0.1, 1.0, transmittance=[0.3])
    assert bent.transmittance.tolist() == [0.3, 0.3]
