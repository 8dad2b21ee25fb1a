"""Panes of scene files: what each format says of transmission."""

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
