"""Textures of files: wraps, filters, colours of meshes, several images, kinds of image files, and images that are too large."""

import itertools

import numpy as np
import pytest
from mitsuba_rays import mitsuba_hits, our_hits, scalar_variant
from samples import CORNERS, Gltf, png

import radiosity as rd
from radiosity.device import backend as device
from radiosity.errors import RadiosityWarning, SceneError
from radiosity.scene import texture_memory
from radiosity.scene.sampler import Sampler

HEAD, TAIL = '<scene version="3.0.0">', "</scene>"
BITMAP = '<texture type="bitmap" name="{0}"><string name="filename" value="{1}"/>{2}</texture>'
QUAD = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 2 0\nvt 2 2\nvt 0 2\nmtllib m.mtl\nusemtl m\nf 1/1 2/2 3/3 4/4\n"


@pytest.fixture(scope="module", autouse=True)
def one_change_of_variant():
    with scalar_variant():
        yield


def srgb(value):
    return ((value / 255 + 0.055) / 1.055) ** 2.4


def generator(seed):
    return np.random.Generator(np.random.Philox(seed))


def above(count, low=-1, high=1):
    """Rays down on the square around the origin."""
    origins = np.column_stack([generator(1).uniform(low, high, (count, 2)), np.full(count, 2.0)])
    return origins, np.tile([0.0, 0.0, -1.0], (count, 1))


def seen(path, rays):
    """What Mitsuba and we find there."""
    return mitsuba_hits(path, *rays)[2], our_hits(rd.load_scene(path), *rays)[2]


@pytest.mark.parametrize(("wrap", "kind"), itertools.product(("repeat", "mirror", "clamp"), ("bilinear", "nearest")))
def test_bitmaps_are_what_mitsuba_evaluates(tmp_path, wrap, kind):
    """At points, and as means over patches of what Mitsuba finds at points: 5 standard errors."""
    (tmp_path / "t.png").write_bytes(png(generator(2).integers(0, 249, (5, 4, 3))))
    move = '<transform name="to_uv"><rotate z="1" angle="25"/><scale x="2.3" y="1.7"/><translate x="-0.7" y="-0.4"/></transform>'
    more = f'<string name="wrap_mode" value="{wrap}"/><string name="filter_type" value="{kind}"/>{move}'
    texture = BITMAP.format("reflectance", "t.png", more)
    path = tmp_path / "scene.xml"
    path.write_text(f'{HEAD}<shape type="rectangle"><bsdf type="diffuse">{texture}</bsdf></shape>{TAIL}')
    rays = above(400)
    theirs, ours = seen(path, rays)
    np.testing.assert_allclose(ours, theirs, atol=2e-3)
    means = rd.subdivide(rd.load_scene(path), cells=3)
    error = theirs.std(axis=0) / np.sqrt(len(theirs))
    assert (np.abs(means.reflectance.mean(axis=0) - theirs.mean(axis=0)) < 5 * error).all()


def test_bitmaps_of_other_names_are_refused(tmp_path):
    (tmp_path / "t.png").write_bytes(png(np.full((2, 2, 3), 99)))
    for more in ('<string name="wrap_mode" value="around"/>', '<string name="filter_type" value="cubic"/>'):
        texture = BITMAP.format("reflectance", "t.png", more)
        (tmp_path / "s.xml").write_text(f'{HEAD}<shape type="rectangle"><bsdf type="diffuse">{texture}</bsdf></shape>{TAIL}')
        with pytest.raises(SceneError, match=r"wrap_mode .* and filter_type .*expected one of 'repeat'"):
            rd.load_scene(tmp_path / "s.xml")


def images(folder):
    """Files of one colour or grey each, by name."""
    from PIL import Image

    grey = np.full((4, 4), 120, np.uint8)
    color = np.tile(np.array([180, 90, 30], np.uint8), (4, 4, 1))
    Image.fromarray(np.eye(4) > 0).save(folder / "1-bit.png")
    Image.fromarray(grey).save(folder / "grey.png")
    Image.fromarray(np.full((4, 4), 30000, np.uint16)).save(folder / "16-bit.png")
    Image.fromarray(np.dstack([grey, grey // 2]), "LA").save(folder / "grey-alpha.png")
    Image.fromarray(np.dstack([color, grey]), "RGBA").save(folder / "color-alpha.png")
    Image.fromarray(color).save(folder / "color.bmp")
    Image.fromarray(color).save(folder / "color.tga")
    Image.fromarray(color).save(folder / "color.jpg", quality=100)

    import mitsuba as mi

    with device.bitmaps():
        mi.Bitmap(np.full((4, 4, 1), 0.3, np.float32)).write(str(folder / "grey.exr"))
        mi.Bitmap(np.tile(np.array([0.5, 0.25, 0.1], np.float32), (4, 4, 1))).write(str(folder / "color.exr"))
        mi.Bitmap(np.tile(np.array([0.5, 0.25, 0.1, 0.5], np.float32), (4, 4, 1))).write(str(folder / "alpha.exr"))
        mi.Bitmap(np.tile(np.array([0.5, 0.25, 0.125], np.float32), (4, 4, 1))).write(str(folder / "color.hdr"))
        mi.Bitmap(np.tile(np.array([0.5, 0.25, 0.1], np.float32), (4, 4, 1))).write(str(folder / "color.pfm"))
    return sorted(file.name for file in folder.iterdir())


def test_kinds_of_image_files_are_what_mitsuba_reads(tmp_path):
    names = images(tmp_path)
    rays = above(12)
    for name, raw in itertools.product(names, (False, True)):
        texture = BITMAP.format("reflectance", name, '<boolean name="raw" value="true"/>' if raw else "")
        (tmp_path / "s.xml").write_text(f'{HEAD}<shape type="rectangle"><bsdf type="diffuse">{texture}</bsdf></shape>{TAIL}')
        if name == "1-bit.png":
            with pytest.warns(RadiosityWarning, match=r"above 0\.95"):
                theirs, ours = seen(tmp_path / "s.xml", rays)
        else:
            theirs, ours = seen(tmp_path / "s.xml", rays)
        np.testing.assert_allclose(ours, theirs, atol=3e-3, err_msg=f"{name} raw={raw}")


PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
{vertex}element face 2
property list uchar int vertex_indices
{face}end_header
-1 -1 0 {0}
1 -1 0 {1}
1 1 0 {2}
-1 1 0 {3}
3 0 1 2 {4}
3 0 2 3 {5}
"""
VALUES = ["0.1 0.2 0.3", "0.4 0.1 0.2", "0.3 0.3 0.1", "0.2 0.5 0.4", "0.9 0.1 0.2", "0.1 0.7 0.3"]


def properties(*names):
    return "".join(f"property float {name}\n" for name in names)


@pytest.mark.parametrize(
    ("vertex", "face", "name"),
    [
        (("r", "g", "b"), ("r", "g", "b"), "vertex_color"),
        (("r", "g", "b"), ("r", "g", "b"), "face_color"),
        (("red", "green", "blue"), ("red", "green", "blue"), "face_color"),
        (("paint_r", "paint_g", "paint_b"), ("k_0", "k_1", "k_2"), "vertex_paint_color"),
        (("q_x", "q_y", "q_z"), ("k_0", "k_1", "k_2"), "face_k"),
        (("one_x", "two_r", "three_0"), ("k_1", "k_2", "k_3"), "vertex_one"),
        (("one_x", "two_r", "three_0"), ("k_1", "k_2", "k_3"), "vertex_two_color"),
    ],
)
def test_colours_of_meshes_are_mitsuba_s_attributes(tmp_path, vertex, face, name):
    (tmp_path / "m.ply").write_text(PLY.format(*VALUES, vertex=properties(*vertex), face=properties(*face)))
    more = '<float name="scale" value="0.5"/>' if name.startswith("face") else ""
    texture = f'<texture type="mesh_attribute" name="reflectance"><string name="name" value="{name}"/>{more}</texture>'
    shape = f'<shape type="ply"><string name="filename" value="m.ply"/><bsdf type="diffuse">{texture}</bsdf></shape>'
    (tmp_path / "s.xml").write_text(HEAD + shape + TAIL)
    theirs, ours = seen(tmp_path / "s.xml", above(40, -0.98, 0.98))
    np.testing.assert_allclose(ours, theirs, atol=1e-5)
    assert np.ptp(theirs, axis=0).max() > 0.01


def test_attributes_of_lamps_and_of_two_sides_and_those_that_are_missing(tmp_path):
    (tmp_path / "m.ply").write_text(PLY.format(*VALUES, vertex=properties("r", "g", "b"), face=properties("r", "g", "b")))
    attribute = '<texture type="mesh_attribute" name="{}"><string name="name" value="{}"/></texture>'
    shape = '<shape type="ply"><string name="filename" value="m.ply"/>{}</shape>'

    def load(inside):
        (tmp_path / "s.xml").write_text(HEAD + shape.format(inside) + TAIL)
        return rd.load_scene(tmp_path / "s.xml")

    black = '<bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>'
    lamp = rd.subdivide(load(f'{black}<emitter type="area">{attribute.format("radiance", "face_color")}</emitter>'), cells=3)
    power = (lamp.emission * lamp.area[:, None]).sum(axis=0)
    np.testing.assert_allclose(power, np.pi * 2 * np.array([1.0, 0.8, 0.5]), rtol=1e-6)
    sides = [f'<bsdf type="diffuse">{attribute.format("reflectance", name)}</bsdf>' for name in ("face_color", "vertex_color")]
    with pytest.warns(RadiosityWarning, match="averaged where the two sides differ"):
        both = load(f'<bsdf type="twosided">{"".join(sides)}</bsdf>')
    np.testing.assert_allclose(both.reflectance[0], [0.5, 0.4, 0.25], rtol=1e-6)
    vertex = np.array([[float(v) for v in row.split()] for row in VALUES[:4]])
    np.testing.assert_allclose(both.back_reflectance[0], (vertex[[0, 1, 2]].mean(axis=0) + vertex[[0, 2, 3]].mean(axis=0)) / 2)
    with pytest.raises(SceneError, match=r"no attribute 'vertex_paint'.*it has 'vertex_color', 'face_color'"):
        load(f'<bsdf type="diffuse">{attribute.format("reflectance", "vertex_paint")}</bsdf>')
    with pytest.raises(SceneError, match="expected one that begins with vertex_ or face_"):
        load(f'<bsdf type="diffuse">{attribute.format("reflectance", "color")}</bsdf>')


def gltf_square(tmp_path, sampler, uv, pixels=((50, 200),)):
    gltf = Gltf()
    index = gltf.image(np.repeat(np.array(pixels)[:, :, None], 3, axis=2))
    if sampler is not None:
        gltf.tree["samplers"] = [sampler]
        gltf.tree["textures"][index]["sampler"] = 0
    material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": index}, "metallicFactor": 0}}
    gltf.node(mesh=gltf.mesh(material=material, attributes={"TEXCOORD_0": gltf.accessor(np.array(uv))}))
    return rd.load_scene(gltf.write(tmp_path / "t.glb"))


WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071}


@pytest.mark.parametrize(("wrap", "share"), [("repeat", 1 / 3), ("mirror", 2 / 3), ("clamp", 2 / 3)])
@pytest.mark.parametrize("axis", [0, 1])
def test_gltf_samplers(tmp_path, wrap, share, axis):
    """One and a half images of a dark and a bright texel: the share of the bright one; the other axis repeats."""
    uv = np.array(CORNERS) * 1.5 if axis == 0 else np.array(CORNERS)[:, ::-1] * 1.5
    pixels = ((50, 200),) if axis == 0 else ((50,), (200,))
    sampler = {"magFilter": 9728, ("wrapS", "wrapT")[axis]: WRAPS[wrap]}
    patches = rd.subdivide(gltf_square(tmp_path, sampler, uv, pixels), cells=1)
    np.testing.assert_allclose(patches.reflectance, srgb(50) + share * (srgb(200) - srgb(50)), rtol=1e-6)
    (kept,) = patches.scene.reflectance_paint.samplers
    assert kept == Sampler(("repeat", wrap) if axis else (wrap, "repeat"), "nearest")


def test_gltf_without_a_sampler_repeats_and_is_linear(tmp_path):
    for sampler in (None, {}, {"minFilter": 9728}):
        scene = gltf_square(tmp_path, sampler, np.array(CORNERS) * (0.5, 1))
        assert scene.reflectance_paint.samplers == (Sampler(),)
        np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, srgb(50) + (srgb(200) - srgb(50)) / 4, rtol=1e-6)
    for sampler in ({"wrapS": 1}, {"magFilter": 9987}, {"wrapT": "REPEAT"}):
        with pytest.raises(SceneError, match="of the sampler of a texture of material"):
            gltf_square(tmp_path, sampler, CORNERS)


def test_obj_textures_that_are_clamped_and_options_that_are_told(tmp_path):
    (tmp_path / "t.png").write_bytes(png(np.repeat([[[50] * 3, [200] * 3]], 2, axis=0)))
    (tmp_path / "x.obj").write_text(QUAD)
    bright, dark = srgb(200), srgb(50)
    means = {"": (bright + dark) / 2, "-clamp off": (bright + dark) / 2, "-clamp on": (dark + 3 * bright) / 4}
    for options, expected in means.items():
        (tmp_path / "m.mtl").write_text(f"newmtl m\nKd 1 1 1\nmap_Kd {options} -bm 2 t.png\n")
        patches = rd.subdivide(rd.load_scene(tmp_path / "x.obj"), cells=1)
        np.testing.assert_allclose(patches.reflectance, expected, rtol=1e-6)
    (tmp_path / "m.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd -t 0.1 0 0 -mm 0.1 0.5 -cc on t.png\n")
    with pytest.warns(RadiosityWarning, match=r"not followed: '-t 0\.1 0 0', '-mm 0\.1 0\.5', '-cc on'"):
        rd.load_scene(tmp_path / "x.obj")


def several(folder, rows, comments=("a.png", "b.png"), texnumber=True):
    for name, color in (("a", (200, 0, 0)), ("b", (0, 0, 200))):
        (folder / f"{name}.png").write_bytes(png(np.tile(np.array(color), (8, 8, 1))))
    text = "ply\nformat ascii 1.0\n" + "".join(f"comment TextureFile {name}\n" for name in comments)
    text += f"element vertex 8\n{properties('x', 'y', 'z')}element face {len(rows)}\nproperty list uchar int vertex_indices\n"
    text += "property list uchar float texcoord\n" + ("property int texnumber\n" if texnumber else "") + "end_header\n"
    points = [f"{x} {y} {z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    (folder / "m.ply").write_text(text + "\n".join([*points, *rows]) + "\n")
    return rd.load_scene(folder / "m.ply")


UV = "8 0 0 1 0 1 1 0 1"


def test_each_face_of_a_ply_has_its_texture(tmp_path):
    scene = several(tmp_path, [f"4 0 1 2 3 {UV} 0", f"4 4 5 6 7 {UV} 1"])
    assert scene.names == ("m",)
    found = rd.subdivide(scene, cells=1)
    np.testing.assert_allclose(found.reflectance[~found.is_back], [[srgb(200), 0, 0], [0, 0, srgb(200)]], rtol=1e-6)
    with pytest.warns(RadiosityWarning, match="no material for 'm'"):
        scene = several(tmp_path, [f"4 0 1 2 3 {UV} -1", f"4 4 5 6 7 {UV} 1"])  # one without a texture
    found = rd.subdivide(scene, cells=1)
    np.testing.assert_allclose(found.reflectance[~found.is_back], [[0.5] * 3, [0, 0, srgb(200)]], rtol=1e-6)
    with pytest.warns(RadiosityWarning, match="no material for 'm'"):
        scene = several(tmp_path, ["4 0 1 2 3 0 0", f"4 4 5 6 7 {UV} 0"])  # or without coordinates
    found = rd.subdivide(scene, cells=1)
    np.testing.assert_allclose(found.reflectance[~found.is_back], [[0.5] * 3, [srgb(200), 0, 0]], rtol=1e-6)
    with pytest.warns(RadiosityWarning, match="names 2 textures, and faces have no texnumber"):
        several(tmp_path, [f"4 0 1 2 3 {UV}"], texnumber=False)
    with pytest.raises(SceneError, match="face 1 has texnumber 2; the file names 2 textures"):
        several(tmp_path, [f"4 0 1 2 3 {UV} 0", f"4 4 5 6 7 {UV} 2"])
    with pytest.raises(SceneError, match="face 1 has 6 texture coordinates for 4 corners"):
        several(tmp_path, [f"4 0 1 2 3 {UV} 0", "4 4 5 6 7 6 0 0 1 0 1 1 0"])


def test_small_parts_of_large_images_are_right_or_told(tmp_path, monkeypatch):
    """One column of 4096: its neighbours have no share in it, but where the image had to be averaged."""
    pixels = np.zeros((2, 4096, 3), np.uint8)
    pixels[:, 2001] = 200
    uv = np.array(CORNERS) * (0.5 / 4096, 1) + (2001.25 / 4096, 0)
    sampler = {"magFilter": 9728}

    def load():
        gltf = Gltf(samplers=[sampler])
        index = gltf.image(pixels)
        gltf.tree["textures"][index]["sampler"] = 0
        material = {"pbrMetallicRoughness": {"baseColorTexture": {"index": index}, "metallicFactor": 0}}
        gltf.node(mesh=gltf.mesh(material=material, attributes={"TEXCOORD_0": gltf.accessor(uv)}))
        return rd.load_scene(gltf.write(tmp_path / "t.glb"))

    np.testing.assert_allclose(rd.subdivide(load(), cells=1).reflectance, srgb(200), rtol=1e-6)
    for name, value in (("LARGEST", 2048), ("MOST_TEXELS", 4096)):
        with monkeypatch.context() as patch:
            patch.setattr(texture_memory, name, value)
            with pytest.warns(RadiosityWarning, match="too large, alone or together, are averaged to 1024 pixels.*image 0"):
                scene = load()
        np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, srgb(200) / 4, rtol=1e-6)
