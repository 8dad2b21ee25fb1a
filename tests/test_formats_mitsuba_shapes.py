"""Shapes of Mitsuba XML lie where Mitsuba's own rays find them, with the same front, texture and area."""

import numpy as np
import pytest
from mitsuba_rays import files, mitsuba_hits, our_hits, random_rays, scalar_variant

import radiosity as rd

HEAD, TAIL = '<scene version="3.0.0">', "</scene>"
WHITE = '<bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf>'
MIRRORS = {"none": "1,1,1", "x": "-1,1,1", "z": "1,1,-1", "half turn": "-1,-1,1"}
COUNT = 60


@pytest.fixture(scope="module", autouse=True)
def one_change_of_variant():
    with scalar_variant():
        yield


def compare(path, *, rough=0.0, colors=False):
    """Hits of the same rays agree; ``rough`` is the distance by which flat faces may miss a round surface."""
    scene = rd.load_scene(path)
    origins, directions = random_rays(scene.bounds, COUNT, 5)
    theirs, ours = mitsuba_hits(path, origins, directions), our_hits(scene, origins, directions)
    both = np.isfinite(theirs[0]) & np.isfinite(ours[0])
    near = both & (np.abs(np.where(both, theirs[0], 0) - np.where(both, ours[0], 0)) <= rough + 1e-4)
    # rays that graze a silhouette may hit one and miss the other
    assert near.sum() >= (0.9 if rough else 1.0) * (np.isfinite(theirs[0]) | np.isfinite(ours[0])).sum()
    assert near.sum() > COUNT / 3
    np.testing.assert_array_equal(theirs[1][near], ours[1][near])
    lit = near & theirs[1]
    if colors:
        assert lit.sum() > 10
        assert np.abs(theirs[2] - ours[2])[lit].max() < 0.03
        assert np.ptp(theirs[2][lit], axis=0).min() > 0.1  # the texture does vary
    return scene


@pytest.mark.parametrize("flip", ["false", "true"])
@pytest.mark.parametrize("mirror", MIRRORS)
@pytest.mark.parametrize("shape", ["rectangle", "disk", "cylinder", "sphere", "cube"])
def test_the_front_of_analytic_shapes(tmp_path, shape, mirror, flip):
    place = f'<scale value="{MIRRORS[mirror]}"/><rotate x="0.6" y="0.8" angle="30"/><scale value="1.5"/><translate x="3" y="-2"/>'
    (tmp_path / "scene.xml").write_text(
        f'{HEAD}<shape type="{shape}">{WHITE}<boolean name="flip_normals" value="{flip}"/>'
        f'<transform name="to_world">{place}</transform></shape>{TAIL}'
    )
    scene = compare(tmp_path / "scene.xml", rough=0.1 if shape in ("disk", "cylinder", "sphere") else 0.0)
    area = {"rectangle": 4, "disk": np.pi, "cylinder": 2 * np.pi, "sphere": 4 * np.pi, "cube": 24}[shape] * 1.5**2
    assert scene.area.sum() == pytest.approx(area, rel=1e-9)


@pytest.mark.parametrize(
    ("shape", "arguments"),
    [
        ("sphere", '<point name="center" x="1" y="2" z="3"/><float name="radius" value="0.5"/>'),
        ("cylinder", '<point name="p0" value="1,2,3"/><point name="p1" value="0,3,1"/><float name="radius" value="0.5"/>'),
    ],
)
def test_arguments_of_round_shapes(tmp_path, shape, arguments):
    (tmp_path / "scene.xml").write_text(f'{HEAD}<shape type="{shape}">{WHITE}{arguments}</shape>{TAIL}')
    compare(tmp_path / "scene.xml", rough=0.05)


@pytest.mark.parametrize("plugin", ["obj", "ply", "serialized"])
@pytest.mark.parametrize("normals", [False, True])
def test_the_front_of_meshes(tmp_path, plugin, normals):
    name = files(tmp_path)[plugin, normals]
    mesh = f'<shape type="{plugin}">{WHITE}<string name="filename" value="{name}"/>'
    for more in ("", '<boolean name="face_normals" value="true"/>', '<boolean name="flip_normals" value="true"/>'):
        for mirror in ("1,1,1", "-1,1,1"):
            place = f'<transform name="to_world"><scale value="{mirror}"/><translate x="1" y="2"/></transform>'
            (tmp_path / "scene.xml").write_text(f"{HEAD}{mesh}{more}{place}</shape>{TAIL}")
            scene = compare(tmp_path / "scene.xml")
            assert scene.n_faces == 6  # its triangles are rectangles again
            assert scene.area.sum() == pytest.approx(24)


@pytest.mark.parametrize("normals", [False, True])
def test_instances(tmp_path, normals):
    name = files(tmp_path)["ply", normals]
    group = f'<shape type="shapegroup" id="g"><shape type="ply">{WHITE}<string name="filename" value="{name}"/></shape></shape>'
    for mirror in ("1,1,1", "-1,1,1"):
        place = f'<transform name="to_world"><scale value="{mirror}"/><translate x="4"/></transform>'
        shapes = f'<shape type="instance" id="one"><ref id="g"/></shape><shape type="instance"><ref id="g"/>{place}</shape>'
        (tmp_path / "scene.xml").write_text(f"{HEAD}{group}{shapes}{TAIL}")
        scene = compare(tmp_path / "scene.xml")
        assert scene.names == (f"one/cube{int(normals)}", f"instance/cube{int(normals)}")


@pytest.mark.parametrize("shape", ["rectangle", "disk", "cylinder", "sphere", "cube", "obj"])
def test_textures_lie_where_mitsuba_puts_them(tmp_path, shape):
    from PIL import Image

    y, x = np.mgrid[0:16, 0:16] / 16
    waves = 128 + 100 * np.stack([np.sin(2 * np.pi * x), np.cos(2 * np.pi * y), np.sin(2 * np.pi * (x + y))], axis=-1)
    Image.fromarray(waves.astype(np.uint8)).save(tmp_path / "waves.png")
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    lines = [f"v {a} {b} {a + b}" for a, b in corners] + [f"vt {(a + 1) / 3} {(b + 1) / 2}" for a, b in corners]
    (tmp_path / "mesh.obj").write_text("\n".join([*lines, "f 1/1 2/2 3/3 4/4"]))
    name = '<string name="filename" value="mesh.obj"/>' if shape == "obj" else ""
    turn = '<transform name="to_uv"><scale x="0.8" y="0.9"/><translate x="0.1"/></transform>'
    texture = f'<texture type="bitmap" name="reflectance"><string name="filename" value="waves.png"/>{turn}</texture>'
    place = '<transform name="to_world"><rotate y="1" angle="40"/></transform>'
    (tmp_path / "scene.xml").write_text(
        f'{HEAD}<shape type="{shape}">{name}{place}<bsdf type="diffuse">{texture}</bsdf></shape>{TAIL}'
    )
    scene = compare(tmp_path / "scene.xml", rough=0.02 if shape in ("disk", "cylinder", "sphere") else 0.0, colors=True)
    assert scene.n_faces == {"rectangle": 1, "cube": 6, "obj": 1}.get(shape, scene.n_faces)


def test_checkerboards_and_raw_images(tmp_path):
    from PIL import Image

    Image.fromarray(np.full((2, 2, 3), 51, np.uint8)).save(tmp_path / "grey.png")
    image = '<texture type="bitmap" name="reflectance"><string name="filename" value="grey.png"/>{}</texture>'
    raw = '<boolean name="raw" value="true"/>'
    colors = '<rgb name="color0" value="0.1"/><rgb name="color1" value="0.5"/>'
    board = f'<texture type="checkerboard" name="reflectance">{colors}</texture>'
    textures = (board, image.format(raw), image.format(""))
    shapes = [f'<shape type="rectangle"><bsdf type="diffuse">{texture}</bsdf></shape>' for texture in textures]
    (tmp_path / "scene.xml").write_text(HEAD + "".join(shapes) + TAIL)
    scene = rd.load_scene(tmp_path / "scene.xml")
    patches = rd.subdivide(scene, cells=4)
    means = np.array([patches.reflectance[patches.surface == i].mean() for i in range(3)])
    np.testing.assert_allclose(means, [0.3, 0.2, ((0.2 + 0.055) / 1.055) ** 2.4], rtol=1e-3)
    quarter = patches.reflectance[patches.surface == 0][:, 0]
    assert sorted(np.unique(quarter.round(3))) == pytest.approx([0.1, 0.5])
    (tmp_path / "scene.xml").write_text(HEAD + shapes[0] + TAIL)
    scene = rd.load_scene(tmp_path / "scene.xml")
    above = np.array([(x, y, 5) for x in (-0.6, 0.7) for y in (-0.4, 0.3)])
    down = np.tile([0.0, 0, -1], (4, 1))
    seen = [hits[2] for hits in (mitsuba_hits(tmp_path / "scene.xml", above, down), our_hits(scene, above, down))]
    np.testing.assert_allclose(*seen, rtol=1e-6)  # which of the colours lies where
    assert sorted(seen[0][:, 0]) == pytest.approx([0.1, 0.1, 0.5, 0.5])


def test_emission_textures(tmp_path):
    from PIL import Image

    Image.fromarray(np.array([[255, 0], [255, 0]], np.uint8)).save(tmp_path / "half.png")
    texture = '<texture type="bitmap" name="radiance"><string name="filename" value="half.png"/></texture>'
    emitter = f'<shape type="rectangle">{WHITE}<emitter type="area">{texture}</emitter></shape>'
    (tmp_path / "scene.xml").write_text(HEAD + emitter + TAIL)
    patches = rd.subdivide(rd.load_scene(tmp_path / "scene.xml"), cells=8)
    assert (patches.emission[:, 0] * patches.area).sum() == pytest.approx(np.pi * 2, rel=1e-3)
