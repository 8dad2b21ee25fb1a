"""Lightmaps: closed forms at every texel, what viewers read at edges and seams, sides, small faces, errors, refusals."""

import json
import struct
from io import BytesIO

import numpy as np
import pytest
from light_samples import bulb, lit
from PIL import Image

import radiosity as rd
from radiosity.cli import main
from radiosity.lightmap import atlas as atlases
from radiosity.lightmap.triangles import Triangles
from radiosity.scene.shapes import box, join, quad

pytest.importorskip("xatlas")
LAMP, POWER = np.array([0.3, -0.4, 1.5]), 100.0


def solved(scene, rays=20_000, cells=1):
    return rd.solve(rd.subdivide(scene, cells=cells), method="gather", rays=rays, replicates=2)


@pytest.fixture(scope="module")
def lamp_over_floor():
    """A point lamp above a grey floor and a black box that it does not reach: no light but that of the lamp."""
    floor, sheet = quad((-1, -1, 0), (2, 0, 0), (0, 2, 0)), quad((1.2, -1, 0), (0, 1, 0), (0.3, 0, -0.4))
    return solved(
        lit(("floor", 0.5, 0.0, [floor]), ("slope", 0.8, 0.0, [sheet]), luminaires=(bulb(tuple(LAMP), 4 * np.pi * POWER),))
    )


def expected(points, normal):
    """Irradiance of the lamp."""
    to = LAMP - points
    return POWER * np.maximum(to @ normal, 0) / np.linalg.norm(to, axis=-1) ** 3


def at(lightmap, places):
    """What a viewer shows at places on the page, texels: values between four texels."""
    column, row = np.moveaxis(np.asarray(places) - 0.5, -1, 0)
    x, y = np.floor(column).astype(int), np.floor(row).astype(int)
    a, b = (column - x)[..., None], (row - y)[..., None]
    value = lightmap.values
    height, width = value.shape[:2]

    def texel(i, j):
        return value[np.clip(y + j, 0, height - 1), np.clip(x + i, 0, width - 1)]

    return (1 - b) * ((1 - a) * texel(0, 0) + a * texel(1, 0)) + b * ((1 - a) * texel(0, 1) + a * texel(1, 1))


def on_triangles(lightmap, shares):
    """Places on the page and points in the scene, at these shares of the corners of every triangle, (m, k, ...)."""
    atlas = lightmap.atlas
    return shares @ atlas.places, shares @ atlas.vertices[atlas.corners]


INNER = np.array([[0.4, 0.35, 0.25], [0.8, 0.1, 0.1], [0.2, 0.2, 0.6]])
EDGES = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0.5, 0.5, 0], [0, 0.3, 0.7], [0.6, 0, 0.4]])


def test_each_texel_has_the_light_at_its_point(lamp_over_floor):
    """To single precision: at texels in charts, and at those beside them, which have the light of the nearest edge."""
    found = rd.bake_lightmap(lamp_over_floor, size=96, lines=16, quantity="irradiance", samples=1)
    texels, scene = found.texels, lamp_over_floor.patches.scene
    face = found.atlas.triangles.face[texels.triangle]
    origin, first, second = (edge[face] for edge in scene.frames)
    points = origin + texels.place[:, :1] * first + texels.place[:, 1:] * second
    light = np.array([expected(p, n) for p, n in zip(points, scene.normal[face], strict=True)])
    inside = found.values[texels.row, texels.column, 0]
    kept = np.abs(texels.place - 0.5).max(axis=1) < 0.499
    assert kept.sum() > 1500
    assert (~texels.inside).sum() > 150
    np.testing.assert_allclose(inside[kept], light[kept], rtol=1e-4)
    np.testing.assert_allclose(inside[~texels.inside], light[~texels.inside], rtol=2e-3)  # drawn in from edges


def test_viewers_show_the_light_at_each_point_to_the_very_edges(lamp_over_floor):
    """Places on the page and points in the scene fit, and nothing bleeds in at edges and seams: 1 % of the light there."""
    found = rd.bake_lightmap(lamp_over_floor, size=200, lines=16, quantity="irradiance", samples=1)
    scene, triangles = lamp_over_floor.patches.scene, found.atlas.triangles
    for shares in (INNER, EDGES):
        places, points = on_triangles(found, shares)
        for k, normal in enumerate(scene.normal[triangles.face]):
            shown = at(found, places[k])[:, 0]
            np.testing.assert_allclose(shown, expected(points[k], normal), rtol=0.01, atol=0.01, err_msg=f"triangle {k}")


def test_what_stands_on_a_floor_has_no_dark_fringe():
    """Where a low black box stands, viewers show the light of the lamp to its very foot: 3 % of it, at 0.15 texels from the box.

    Texels there have points below the box, all of whose lines meet backs. Far below the box it stays dark.
    """
    corner, sides = np.array([-0.33, 0.11, 0.0]), np.array([0.41, 0.37, 0.02])
    parts = [("floor", 0.5, 0.0, [quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))]), ("box", 0.0, 0.0, box(corner, corner + sides))]
    solution = solved(lit(*parts, luminaires=(bulb(tuple(LAMP), 4 * np.pi * POWER),)))
    found = rd.bake_lightmap(solution, texels_per_metre=30.0, lines=64, quantity="irradiance", errors=True)
    atlas = found.atlas
    scene = atlas.triangles.scene
    floor = np.flatnonzero(scene.surface[atlas.triangles.face] == scene.names.index("floor"))[0]
    flat = np.column_stack([atlas.vertices[atlas.corners[floor]][:, :2], np.ones(3)])
    to_page = np.linalg.solve(flat, atlas.places[floor])  # of points of the floor
    along = np.linspace(0.1, 0.9, 200)  # beside the corner lies the shadow of the box
    foot = corner + sides * np.stack([along, np.zeros(200), np.zeros(200)], axis=1) - [0, 0.15 / 30, 0]
    places = np.column_stack([foot[:, :2], np.ones(200)]) @ to_page
    np.testing.assert_allclose(at(found, places)[:, 0], expected(foot, np.array([0, 0, 1.0])), rtol=0.03)
    below = np.append((corner + sides / 2)[:2], 1) @ to_page
    assert at(found, below[None]) == 0
    assert (found.standard_error >= 0).all()


def test_points_are_spread_over_a_texel(lamp_over_floor):
    """Their mean is the middle, they differ, and stay within half a texel and the face."""
    from radiosity.lightmap.texels import Texels, points_of

    atlas = atlases.make(Triangles.of(lamp_over_floor.patches.scene), density=10.0)
    texels = Texels.of(atlas)
    places = np.array(points_of(atlas, texels, 4))
    floor = (atlas.triangles.face[texels.triangle] == 1) & texels.inside
    assert floor.sum() > 300
    inner = floor & (np.abs(texels.place - 0.5).max(axis=1) < 0.45)
    np.testing.assert_allclose(places[:, inner].mean(axis=0), texels.place[inner], atol=0.01)
    apart = np.abs(places[:, inner] - texels.place[inner])
    assert apart.max() <= 0.5 / 20 * 1.01  # of two metres, at ten texels a metre
    assert apart.max() > 0.3 / 20
    assert (places[:, ~texels.inside] == texels.place[~texels.inside]).all()


def test_radiosity_has_the_colour_and_irradiance_has_not(lamp_over_floor):
    one, other = (rd.bake_lightmap(lamp_over_floor, size=64, lines=16, quantity=q) for q in ("irradiance", "radiosity"))
    rho = lamp_over_floor.patches.scene.reflectance[one.atlas.triangles.face[one.texels.triangle]]
    assert len(np.unique(rho)) > 1
    here = one.texels.row, one.texels.column
    np.testing.assert_allclose(other.values[here], rho * one.values[here], rtol=1e-12)


def test_a_furnace_is_even():
    """All walls emit 1 and reflect 0.6: 2.5 at every texel. The mean of 6 000 texels errs by 0.1 %."""
    room = join([("walls", 0.6, 1.0, box((0, 0, 0), (2, 1, 3), inward=True))], source="furnace")
    found = rd.bake_lightmap(solved(room, 200_000, 2), size=96, lines=64)
    assert found.covered.mean() > 0.6
    assert abs(found.values[found.covered].mean() / 2.5 - 1) < 0.005
    np.testing.assert_allclose(found.values, 2.5, rtol=0.2)


def between_lamps(below):
    """A two-sided floor, a lamp of 10 W/m² above it, and one below."""
    floor = quad((-1, -1, 0), (2, 0, 0), (0, 2, 0))
    lamps = quad((-0.5, -0.5, 1), (0, 1, 0), (1, 0, 0)), quad((-0.5, -0.5, -1), (1, 0, 0), (0, 1, 0))
    parts = [("floor", 0.5, 0.0, [floor]), ("above", 0.0, 10.0, [lamps[0]]), ("below", 0.0, below, [lamps[1]])]
    return solved(join(parts, source="sheet", backs={"floor": 0.5}))


def test_both_sides_have_places_and_light_of_their_own():
    found = rd.bake_lightmap(between_lamps(1.0), size=64, lines=64, quantity="irradiance")
    back = found.atlas.triangles.back[found.texels.triangle]
    here = found.values[found.texels.row, found.texels.column, 0]
    assert back.sum() > 300
    front = ~back & (found.atlas.triangles.face[found.texels.triangle] == 0)
    assert here[front].mean() / here[back].mean() == pytest.approx(10, rel=0.02)


def test_dark_sides_share_one_black_texel():
    """Two triangles of the floor's back, and two of what lies below it; nothing dark bleeds into the rest."""
    found = rd.bake_lightmap(between_lamps(0.0), size=64, lines=64, quantity="irradiance")
    atlas, triangles = found.atlas, found.atlas.triangles
    assert triangles.dark.sum() == 4
    assert triangles.dark[triangles.back].all()
    places = atlas.places[triangles.dark].reshape(-1, 2)
    assert (places == places[0]).all()
    assert at(found, places[:1]) == 0
    assert (triangles.dark[found.texels.triangle]).sum() <= 9
    shown = at(found, atlas.places[~triangles.dark].reshape(-1, 2))
    assert shown.min() > 0.25  # 0.3 at the corners of the lamp


def test_where_all_is_dark_each_side_keeps_its_place():
    scene = between_lamps(0.0).patches.scene
    assert not Triangles.of(scene, np.ones((scene.n_faces, 2), bool)).dark.any()


def test_edges_are_seen_from_within_their_faces():
    """A wall stands a hair's breadth inside the edge of a floor, and hides the edge from the lamp; texels see none of that."""
    floor, wall = quad((-1, -1, 0), (2, 0, 0), (0, 2, 0)), quad((0.99999, -1, 0), (0, 2, 0), (0, 0, 2))
    scene = lit(("floor", 0.5, 0.0, [floor]), ("wall", 0.0, 0.0, [wall]), luminaires=(bulb(tuple(LAMP), 4 * np.pi * POWER),))
    found = rd.bake_lightmap(solved(scene), texels_per_metre=20.0, lines=16, quantity="irradiance")
    atlas, triangles = found.atlas, found.atlas.triangles
    on_floor = triangles.scene.surface[triangles.face] == triangles.scene.names.index("floor")
    edge = on_floor[:, None] & (triangles.place[..., 0] == 1)
    points = atlas.vertices[atlas.corners][edge]
    np.testing.assert_allclose(at(found, atlas.places[edge])[:, 0], expected(points, np.array([0, 0, 1.0])), rtol=0.03)


def test_dim_faces_share_no_chart_with_lit_ones():
    """A surface of two squares side by side, one of which is dim: at the edge of the lit one a viewer reads its light alone."""
    floor = [quad((-1, -1, 0), (1, 0, 0), (0, 2, 0)), quad((0, -1, 0), (1, 0, 0), (0, 2, 0))]
    cover, lamp = quad((0, -1, 0.001), (0, 2, 0), (1, 0, 0)), quad((-1, -0.5, 1), (0, 1, 0), (1, 0, 0))
    scene = join([("floor", 0.5, 0.0, floor), ("cover", 0.0, 0.0, [cover]), ("lamp", 0.0, 10.0, [lamp])], source="dim")
    found = rd.bake_lightmap(solved(scene), texels_per_metre=20.0, lines=64, quantity="irradiance")
    triangles = found.atlas.triangles
    edge = (triangles.face == 0)[:, None] & (triangles.place[..., 0] == 1)
    x, y = np.meshgrid((np.arange(50) + 0.5) / 50 - 1, (np.arange(50) + 0.5) / 50 - 0.5)
    light = 10 / np.pi * np.mean(1 / (1 + x**2 + (y - 1) ** 2) ** 2)  # of the lamp, at both ends of the edge
    assert edge.sum() == 3
    np.testing.assert_allclose(at(found, found.atlas.places[edge]), light, rtol=0.1)


def test_faces_too_small_for_a_chart_have_a_texel():
    large, small = quad((-50, -50, 0), (100, 0, 0), (0, 100, 0)), quad((0, 0, 1), (1e-4, 0, 0), (0, 1e-4, 0))
    triangles = Triangles.of(join([("floor", 0.5, 1.0, [large]), ("speck", 0.5, 0.0, [small])], source="speck"))
    atlas = atlases.make(triangles, size=64)
    assert max(atlas.width, atlas.height) <= 64
    speck, rest = (atlas.places[triangles.face == face].reshape(-1, 2) for face in (1, 0))
    one, other = speck[:3], speck[3:]
    assert (one == one[0]).all()
    assert (other == other[0]).all()
    assert (speck % 1 == 0.5).all()
    for a, b in ((one, other), (one, rest), (other, rest)):
        assert np.abs(a[0] - np.clip(a[0], b.min(axis=0), b.max(axis=0))).max() >= 4


def test_charts_keep_their_distance():
    """Of the texels that belong to other charts none is nearer than the padding, less the two borders that are read."""
    scene = rd.load_scene("studio")
    atlas = atlases.make(Triangles.of(scene), size=160, padding=5)
    from radiosity.lightmap.texels import Texels

    texels = Texels.of(atlas)
    inside = texels.inside
    row, column, chart = texels.row[inside], texels.column[inside], atlas.chart[texels.triangle[inside]]
    page = np.full((atlas.height, atlas.width), -1)
    page[row, column] = chart
    for down, right in ((0, 1), (0, 4), (1, 0), (4, 0), (3, 3)):
        one, other = page[: atlas.height - down, : atlas.width - right], page[down:, right:]
        assert not ((one >= 0) & (other >= 0) & (one != other)).any()


def test_the_density_is_what_was_asked_for(lamp_over_floor):
    atlas = atlases.make(Triangles.of(lamp_over_floor.patches.scene), density=30.0)
    scene = lamp_over_floor.patches.scene
    surface = scene.surface[atlas.triangles.face]
    places = atlas.places[surface == scene.names.index("floor")][0]
    assert np.linalg.norm(places[1] - places[0]) == pytest.approx(60, rel=0.03)


def test_equal_seeds_give_equal_bits():
    solution = solved(rd.load_scene("room"), 50_000)
    one, again, other = (rd.bake_lightmap(solution, size=48, lines=16, seed=seed) for seed in (3, 3, 4))
    assert np.array_equal(one.values, again.values)
    assert not np.array_equal(one.values, other.values)


def test_errors_are_those_of_the_lines():
    """The spread of two bakes is what both say, over some 1 000 texels: the ratio of RMS values within 15 %."""
    solution = solved(rd.load_scene("room"), 50_000)
    one, other = (rd.bake_lightmap(solution, size=48, lines=64, samples=1, errors=True, seed=seed) for seed in (1, 2))
    here = one.texels.row, one.texels.column
    spread = np.sqrt(np.mean((one.values[here] - other.values[here]) ** 2))
    said = np.sqrt(np.mean(one.standard_error[here] ** 2) + np.mean(other.standard_error[here] ** 2))
    assert spread == pytest.approx(said, rel=0.15)


def test_noise_is_filtered():
    """The RMS error against many lines falls by a tenth at least, where texels are small."""
    solution = solved(rd.load_scene("room"), 50_000)
    rough, less, best = (
        rd.bake_lightmap(solution, size=96, lines=lines, samples=1, denoise=denoise)
        for lines, denoise in ((16, False), (16, True), (512, False))
    )
    here = rough.texels.row, rough.texels.column
    errors = [np.sqrt(np.mean((one.values[here] - best.values[here]) ** 2)) for one in (rough, less)]
    assert errors[1] < 0.9 * errors[0]


def test_a_glb_holds_the_texture_and_where_it_lies(tmp_path, lamp_over_floor):
    """The picture in the file, read at the places of the file's vertices, is the light at their points."""
    found = rd.bake_lightmap(lamp_over_floor, size=256, lines=16, quantity="irradiance")
    files = found.save(tmp_path / "a.glb", scale=0.004)
    assert [file.name for file in files] == ["a.glb", "a.exr"]
    data = files[0].read_bytes()
    length = struct.unpack("<I", data[12:16])[0]
    contents, binary = json.loads(data[20 : 20 + length]), data[28 + length :]

    def read(number):
        accessor = contents["accessors"][number]
        view = contents["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5125: "<u4"}[accessor["componentType"]]
        values = np.frombuffer(binary[view["byteOffset"] :][: view["byteLength"]], kind)
        return values.reshape(accessor["count"], -1).astype(float)

    view = contents["bufferViews"][contents["images"][0]["bufferView"]]
    picture = np.asarray(Image.open(BytesIO(binary[view["byteOffset"] :][: view["byteLength"]])), float) / 255
    linear = np.where(picture <= 0.04045, picture / 12.92, ((picture + 0.055) / 1.055) ** 2.4)
    for node, normal in zip(contents["nodes"][1:3], lamp_over_floor.patches.scene.normal[:2], strict=True):
        attributes = contents["meshes"][node["mesh"]]["primitives"][0]["attributes"]
        assert attributes["TEXCOORD_0"] == attributes["TEXCOORD_1"]
        points, places = read(attributes["POSITION"]), read(attributes["TEXCOORD_0"])
        middle, place = points.mean(axis=0), places.mean(axis=0) * picture.shape[1::-1]
        column, row = place.astype(int)
        assert linear[row, column, 0] / 0.004 == pytest.approx(expected(middle, normal), rel=0.02)
    assert contents["asset"]["extras"]["unit"] == found.unit


def test_the_command_writes_what_it_says(tmp_path, capsys):
    solved(rd.load_scene("cornell-box")).save(tmp_path / "a.npz")
    options = ["--size", "64", "--lines", "64", "--errors", "--tone-map", "agx", "--quantity", "irradiance"]
    assert main(["lightmap", str(tmp_path / "a.npz"), "-o", str(tmp_path / "b.glb"), *options]) == 0
    said = capsys.readouterr().out
    for name in ("b.glb", "b.exr", "b.error.exr"):
        assert (tmp_path / name).exists()
        assert name in said


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"size": 8}, "size is 8; it must be a whole number of texels from 16 to 8192"),
        ({"size": 64, "texels_per_metre": 3}, "not both"),
        ({"texels_per_metre": 1e6}, "do not fit on a page"),
        ({"texels_per_metre": 0}, "positive"),
        ({"padding": 1}, "padding is 1"),
        ({"size": 16, "padding": 60}, "does not hold a place for each of its 2 triangles"),
        ({"lines": 2}, "lines is 2; it must be a whole number of lines a texel, from 16"),
        ({"lines": 8, "errors": True}, "4 for each of 16 samples and independent parts"),
        ({"quantity": "relative_error", "size": 32}, "a final gather finds"),
        ({"samples": 0, "size": 32}, "samples is 0"),
        ({"quantity": "hits"}, "quantity 'hits' does not exist"),
    ],
)
def test_senseless_options_are_refused(lamp_over_floor, options, message):
    with pytest.raises(rd.OutputError, match=message):
        rd.bake_lightmap(lamp_over_floor, **options)


def test_a_missing_library_is_named(monkeypatch, lamp_over_floor):
    from radiosity.image import output

    monkeypatch.setattr(output, "find_spec", lambda name: None)
    with pytest.raises(rd.OutputError, match=r"needs 'xatlas', which is not installed; pip install 'radiosity\[lightmap\]'"):
        rd.bake_lightmap(lamp_over_floor)
