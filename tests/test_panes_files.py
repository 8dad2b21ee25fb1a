"""Panes of scene files: what each format says of transmission."""

import json

import numpy as np
import pytest
from mitsuba_rays import scalar_mitsuba
from samples import Gltf

import radiosity as rd

OBJ = "mtllib m.mtl\no glass\nusemtl clear\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
MTL = "newmtl clear\nKd 0.1 0.1 0.1\n"
WHITE = '<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>'


@pytest.fixture
def toml(tmp_path):
    """Loads a .toml of one square with these settings; warnings are errors, as everywhere in the tests."""
    (tmp_path / "m.mtl").write_text(MTL)
    (tmp_path / "a.obj").write_text(OBJ)

    def load(settings, file="a.obj"):
        (tmp_path / "a.toml").write_text(f'geometry = "{file}"\n[[surface]]\nname = "*"\n{settings}\n')
        return rd.load_scene(tmp_path / "a.toml")

    return load


def test_toml(toml):
    scene = toml("transmittance = 0.8")
    assert scene.transmittance.tolist() == [0.8]
    assert scene.reflectance.ravel() == pytest.approx([0.1])
    assert toml("transmittance = 0").transmittance is None
    later = 'transmittance = 0.8\n[[surface]]\nname = "glass/clear"\ntransmittance = 0.6\nreflectance = 0.3'
    assert toml(later).transmittance.tolist() == [0.6]


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ("transmittance = 1", r"transmittance.*leave the surface out"),
        ("transmittance = -0.1", "transmittance"),
        ("transmittance = [0.1, 0.2, 0.3]", "transmittance"),
        (
            "transmittance = 0.95",
            r"'glass/clear' has a transmittance of 0\.95, and its reflectance is 0\.1; .*give its reflectance",
        ),
        ("transmittance = 0.5\nreflectance = 0.6", r"transmittance of 0\.5, and its reflectance is 0\.6"),
        ('transmittance = 0.5\nreflectance = 0\nback = "open"', "open, so that all lines pass already"),
    ],
)
def test_toml_that_makes_no_sense(toml, settings, message):
    with pytest.raises(rd.SceneError, match=message):
        toml(settings)


def test_toml_of_heat(toml, tmp_path):
    """Where no file gives a reflectance, a pane reflects what it neither absorbs nor lets through."""
    (tmp_path / "b.obj").write_text(OBJ.replace("usemtl clear\n", "").replace("mtllib m.mtl\n", ""))
    scene = toml("transmittance = 0.2\nemissivity = 0.7", "b.obj")
    assert scene.reflectance.item() == pytest.approx(0.1)
    with pytest.raises(rd.SceneError, match=r"emissivity 0\.9 and transmittance 0\.2, above 1"):
        toml("transmittance = 0.2\nemissivity = 0.9", "b.obj")
    with pytest.raises(rd.SceneError, match=r"without a material it is taken as 0\.5"):
        toml("transmittance = 0.6", "b.obj")


def test_mgf(tmp_path):
    """`ts` goes straight on; a colour of it is told; `ts` 1 is nothing; rd that leaves no loss is brought down."""
    pytest.importorskip("pyradiance")
    corners = "".join(f"v {n} =\n p {x} {y} 0\n" for n, x, y in (("a", 0, 0), ("b", 1, 0), ("c", 1, 1), ("d", 0, 1)))
    glass = "m glass =\n c\n rd 0.1\n ts 0.8 0\nf a b c d\n"
    tinted = "m tinted =\n c\n rd 0\n c red =\n cxy 0.6 0.3\n ts 0.4 0\nf a b c d\n"
    lossless = "m lossless =\n c\n rd 0.25\n ts 0.75 0\nf a b c d\n"
    (tmp_path / "a.mgf").write_text(corners + glass)
    scene = rd.load_scene(tmp_path / "a.mgf")
    assert scene.transmittance.tolist() == [0.8]
    assert scene.reflectance.tolist() == [[0.1]]
    (tmp_path / "b.mgf").write_text(corners + tinted)
    with pytest.warns(rd.RadiosityWarning, match=r"coloured panes .* by their luminance \(ts\): 'tinted'"):
        assert rd.load_scene(tmp_path / "b.mgf").transmittance.tolist() == [0.4]
    (tmp_path / "c.mgf").write_text(corners + glass + "m air =\n c\n ts 1 0\nf a b c d\n")
    with pytest.warns(rd.RadiosityWarning, match=r"let all light through are not there, and left out: 'air'"):
        assert rd.load_scene(tmp_path / "c.mgf").names == ("glass",)
    (tmp_path / "d.mgf").write_text(corners + lossless)
    with pytest.warns(rd.RadiosityWarning, match=r"above 0\.95 brought down to it .*'lossless'"):
        assert rd.load_scene(tmp_path / "d.mgf").reflectance.item() == pytest.approx(0.95 * 0.25)


def test_gltf(tmp_path):
    """The base colour colours what goes through, 4 % are mirrored; a texture of the factor is told."""
    color = {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}

    def told(transmission):
        gltf = Gltf()
        extension = {"KHR_materials_transmission": transmission}
        gltf.node(mesh=gltf.mesh(material={"name": "pane", "pbrMetallicRoughness": color, "extensions": extension}), name="a")
        if transmission["transmissionFactor"] > 1:
            return rd.load_scene(gltf.write(tmp_path / "a.glb")), []
        with pytest.warns(rd.RadiosityWarning) as caught:
            scene = rd.load_scene(gltf.write(tmp_path / "a.glb"))
        return scene, [str(w.message) for w in caught]

    scene, texts = told({"transmissionFactor": 0.75})
    assert scene.transmittance == pytest.approx([0.96 * 0.75 * 0.5])
    assert scene.reflectance.item() == pytest.approx(0.125)
    assert any("transmission makes clear panes" in text and "'pane (0.36)'" in text for text in texts)
    assert any("not diffuse" in text for text in texts)
    scene, texts = told({"transmissionFactor": 0.75, "transmissionTexture": {"index": 0}})
    assert scene.transmittance is None
    assert scene.reflectance.item() == 0.5
    assert any("transparency is left out" in text for text in texts)
    with pytest.raises(rd.SceneError, match=r"transmission of 'pane' has the factor 1\.5"):
        told({"transmissionFactor": 1.5})


def mitsuba(tmp_path, bsdf):
    (tmp_path / "a.xml").write_text(f'<scene version="3.0.0"><shape type="rectangle" id="pane">{bsdf}</shape></scene>')
    return rd.load_scene(tmp_path / "a.xml")


def test_mitsuba_thin_dielectric(tmp_path):
    """The mean over the hemisphere of what Mitsuba's own BSDF lets through, at 1000 cosines."""
    with pytest.warns(rd.RadiosityWarning) as caught:
        scene = mitsuba(tmp_path, '<bsdf type="thindielectric"><float name="int_ior" value="1.52"/></bsdf>')
    assert any("thin dielectrics make clear panes" in str(w.message) for w in caught)
    with scalar_mitsuba() as mi:
        bsdf, found = mi.load_dict({"type": "thindielectric", "int_ior": 1.52}), []
        for cosine in (np.arange(1000) + 0.5) / 1000:
            si = mi.SurfaceInteraction3f()
            si.wi = [float(np.sqrt(1 - cosine**2)), 0, float(cosine)]
            sample, _ = bsdf.sample(mi.BSDFContext(), si, 1.0, [0.5, 0.5])
            found.append(2 * cosine * sample.pdf)
    assert scene.transmittance.item() == pytest.approx(np.mean(found), abs=1e-5)
    assert scene.reflectance.item() == 0
    with pytest.raises(rd.SceneError, match="int_ior is 'glue'"):
        mitsuba(tmp_path, '<bsdf type="thindielectric"><string name="int_ior" value="glue"/></bsdf>')


def test_mitsuba_mask_with_an_image_of_white_keeps_a_loss(tmp_path):
    """A mask around white reflects 0.95 of what it does not let through."""
    white = WHITE.replace("0.5", "1")
    with pytest.warns(rd.RadiosityWarning):
        scene = mitsuba(tmp_path, f'<bsdf type="mask"><float name="opacity" value="0.4"/>{white}</bsdf>')
    assert scene.transmittance.tolist() == [0.6]
    assert scene.reflectance.item() == pytest.approx(0.4 * 0.95)


DIFFUSE = "KHR_materials_diffuse_transmission"


def test_toml_of_diffuse_light(toml):
    scene = toml("diffuse_transmittance = 0.5\nsides = 2")
    assert scene.diffuse_transmittance.tolist() == [[0.5]]
    assert toml("diffuse_transmittance = [0.5, 0.4, 0.3]").diffuse_transmittance.tolist() == [[0.5, 0.4, 0.3]]
    assert toml("diffuse_transmittance = 0").diffuse_transmittance is None
    both = toml("diffuse_transmittance = 0.3\ntransmittance = 0.5")
    assert (both.transmittance.item(), both.diffuse_transmittance.item()) == (0.5, 0.3)
    for settings, message in (
        ("diffuse_transmittance = 0.95", r"'glass/clear' has a diffuse transmittance of 0\.95.*reflectance is 0\.1"),
        ("diffuse_transmittance = 0.5\ntransmittance = 0.45", r"diffuse transmittance of 0\.5 and a clear one of 0\.45"),
        ("diffuse_transmittance = -0.1", "diffuse_transmittance"),
        ("diffuse_transmittance = 0.5\nsides = 1", r"glass/clear.*two-sided"),
    ):
        with pytest.raises(rd.SceneError, match=message):
            toml(settings)


def test_gltf_of_diffuse_light(tmp_path):
    def load(double=True, color=(0.6, 0.6, 0.6), **extensions):
        gltf = Gltf()
        metal = {"baseColorFactor": [*color, 1], "metallicFactor": 0, "roughnessFactor": 1}
        paper = {"name": "paper", "doubleSided": double, "pbrMetallicRoughness": metal, "extensions": extensions}
        gltf.node(mesh=gltf.mesh(material=paper))
        return rd.load_scene(gltf.write(tmp_path / "a.glb"))

    scene = load(**{DIFFUSE: {"diffuseTransmissionFactor": 0.25, "diffuseTransmissionColorFactor": [0.8, 0.6, 0.4]}})
    np.testing.assert_allclose(scene.reflectance, [[0.45] * 3])
    np.testing.assert_allclose(scene.diffuse_transmittance, [[0.2, 0.15, 0.1]])
    assert scene.back.tolist() == [rd.Back.RADIATES]
    with pytest.warns(rd.RadiosityWarning, match="two-sided here, though the file calls them single-sided: 'paper'"):
        scene = load(double=False, **{DIFFUSE: {"diffuseTransmissionFactor": 0.5}})
    np.testing.assert_allclose([scene.reflectance, scene.diffuse_transmittance], [[[0.3]], [[0.5]]])
    with pytest.warns(rd.RadiosityWarning, match="transparency is left out, taken as opaque: 'paper'"):
        scene = load(**{DIFFUSE: {"diffuseTransmissionFactor": 0.5, "diffuseTransmissionTexture": {"index": 0}}})
    assert scene.diffuse_transmittance is None
    assert scene.reflectance.item() == 0.6


@pytest.mark.filterwarnings("ignore:.*transmission makes clear panes", "ignore:.*not diffuse")
def test_gltf_of_both_kinds_of_light(tmp_path):
    """Half is transmitted straight on, and a quarter of the diffuse rest goes through."""
    gltf = Gltf()
    metal = {"baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0, "roughnessFactor": 1}
    more = {
        "KHR_materials_transmission": {"transmissionFactor": 0.5},
        DIFFUSE: {"diffuseTransmissionFactor": 0.25, "diffuseTransmissionColorFactor": [0.4] * 3},
    }
    gltf.node(mesh=gltf.mesh(material={"name": "paper", "doubleSided": True, "pbrMetallicRoughness": metal, "extensions": more}))
    scene = rd.load_scene(gltf.write(tmp_path / "a.glb"))
    np.testing.assert_allclose(scene.transmittance, [0.5 * 0.96 * 0.8])
    np.testing.assert_allclose(scene.reflectance, [[0.5 * 0.75 * 0.8]])
    np.testing.assert_allclose(scene.diffuse_transmittance, [[0.5 * 0.25 * 0.4]])


def test_mgf_of_diffuse_light(tmp_path):
    pytest.importorskip("pyradiance")
    text = "v a =\n p 0 0 0\nv b =\n p 1 0 0\nv c =\n p 1 1 0\nv d =\n p 0 1 0\nm opal =\n c\n rd 0.3\n {}\nf a b c d\n"

    def load(more):
        (tmp_path / "a.mgf").write_text(text.format(more))
        return rd.load_scene(tmp_path / "a.mgf")

    scene = load("td 0.4")
    assert (scene.reflectance.item(), scene.diffuse_transmittance.item()) == (0.3, 0.4)
    scene = load("td 0.4\n ts 0.2")
    assert (scene.transmittance.item(), scene.diffuse_transmittance.item()) == (0.2, 0.4)
    with pytest.warns(rd.RadiosityWarning, match="sides 1.*td is left out"):
        assert load("td 0.4\n sides 1").diffuse_transmittance is None
    with pytest.warns(rd.RadiosityWarning, match="reflectance above 0.95 brought down"):
        scene = load("td 0.7")
    np.testing.assert_allclose([scene.reflectance, scene.diffuse_transmittance], [[[0.285]], [[0.665]]])


def test_mitsuba_of_diffuse_light(tmp_path):
    text = (
        '<scene version="3.0.0"><shape type="rectangle" id="sheet"><bsdf type="principledthin">'
        '<rgb name="base_color" value="0.6"/><float name="diff_trans" value="0.5"/></bsdf></shape></scene>'
    )
    (tmp_path / "a.xml").write_text(text)
    with pytest.warns(rd.RadiosityWarning, match="not diffuse"):
        scene = rd.load_scene(tmp_path / "a.xml")
    np.testing.assert_allclose(scene.reflectance, [[0.45]])
    np.testing.assert_allclose(scene.diffuse_transmittance, [[0.15]])
    assert scene.back.tolist() == [rd.Back.RADIATES]


def test_mitsuba_agrees(tmp_path):
    """Mitsuba's own sheet, integrated over directions on both sides, gives what the reader takes from it."""
    told = {"type": "principledthin", "base_color": {"type": "rgb", "value": 0.6}, "diff_trans": 0.5, "roughness": 1.0}
    z, turn, found = (np.arange(24) + 0.5) / 24, (np.arange(24) + 0.5) / 24 * 2 * np.pi, []
    with scalar_mitsuba() as mi:
        sheet, si = mi.load_dict({**told, "eta": 1.0001}), mi.SurfaceInteraction3f()
        si.wi = mi.Vector3f(0, 0, 1)
        for sign in (1, -1):
            ways = [(np.sqrt(1 - h * h) * np.cos(t), np.sqrt(1 - h * h) * np.sin(t), sign * h) for h in z for t in turn]
            found.append(np.mean([sheet.eval(mi.BSDFContext(), si, mi.Vector3f(*way))[0] for way in ways]) * 2 * np.pi)
    assert found == pytest.approx([0.45, 0.15], rel=0.05)


def test_honeybee_of_diffuse_light(tmp_path):
    pytest.importorskip("pydantic")
    opal = {"type": "Trans", "identifier": "opal", "r_reflectance": 0.8, "g_reflectance": 0.8, "b_reflectance": 0.8}
    opal |= {"transmitted_diff": 0.5, "transmitted_spec": 0.25}
    boundary = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    shade = {"type": "Shade", "identifier": "veil", "geometry": {"type": "Face3D", "boundary": boundary}}
    shade["properties"] = {"type": "ShadePropertiesAbridged", "radiance": {"type": "x", "modifier": "opal"}}
    model = {"type": "Model", "identifier": "m", "units": "Meters", "orphaned_shades": [shade]}
    model["properties"] = {"type": "ModelProperties", "radiance": {"type": "x", "modifiers": [opal]}}
    (tmp_path / "m.hbjson").write_text(json.dumps(model))
    scene = rd.load_scene(tmp_path / "m.hbjson")
    np.testing.assert_allclose([scene.reflectance.item(), scene.diffuse_transmittance.item()], [0.4, 0.3])
    np.testing.assert_allclose(scene.transmittance, [0.1])


def test_conversions_keep_what_goes_through_or_tell(tmp_path):
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    scene = rd.Scene.from_arrays(
        np.concatenate([np.add(corners, [0, 0, z]) for z in range(3)]),
        np.arange(12).reshape(3, 4),
        [0.25, 0.0, 0.5],
        [0.0, 0.0, 1.0],
        surface=[0, 1, 2],
        names=["opal", "glass", "lamp"],
        two_sided=True,
        back_reflectance=[0.25, 0.0, 0.5],
        transmittance=[0.125, 0.75, 0.0],
        refractive_index=[0.0, 1.5, 0.0],
        diffuse_transmittance=[0.375, 0.0, 0.0],
    )
    rd.save_scene(scene, tmp_path / "a.toml")
    again = rd.load_scene(tmp_path / "a.toml")
    for name in ("transmittance", "refractive_index", "diffuse_transmittance", "reflectance"):
        np.testing.assert_allclose(getattr(again, name), getattr(scene, name), rtol=1e-12, err_msg=name)
    with pytest.warns(rd.RadiosityWarning) as told:
        rd.save_scene(scene, tmp_path / "a.glb")
    text = "\n".join(str(one.message) for one in told)
    assert "glass gets one transmittance for all angles: 'glass'" in text
