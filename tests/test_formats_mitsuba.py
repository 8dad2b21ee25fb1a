"""Mitsuba XML: materials, emitters, names, cameras, and what has to be left out."""

import numpy as np
import pytest

import radiosity as rd

HEAD, TAIL = '<scene version="3.0.0">', "</scene>"
WHITE = '<bsdf type="diffuse"><rgb name="reflectance" value="0.7"/></bsdf>'
QUAD = '<shape type="rectangle">{}</shape>'


@pytest.fixture
def load(tmp_path):
    """Loads the inside of a scene element; warnings are errors, as everywhere in the tests."""

    def of(inside, **options):
        (tmp_path / "scene.xml").write_text(HEAD + inside + TAIL)
        return rd.load_scene(tmp_path / "scene.xml", **options)

    return of


def only(scene):
    """Front, back and side rule of a scene of one face."""
    assert scene.n_faces == 1
    return scene.reflectance[0].tolist(), scene.back_reflectance[0].tolist(), rd.Back(scene.back[0])


def test_one_sided_diffuse_absorbs_on_the_back(load):
    scene = load(QUAD.format(WHITE))
    assert only(scene) == ([pytest.approx(0.7)], [pytest.approx(0.7)], rd.Back.ABSORBS)
    assert scene.bands == ("grey",)
    assert not scene.photometric


def test_twosided_radiates_nested_named_or_by_reference(load):
    named = (
        '<bsdf type="twosided" id="w"><bsdf type="diffuse" name="inner"><rgb name="reflectance" value=".1,.2,.3"/></bsdf></bsdf>'
    )
    scene = load(named + QUAD.format('<ref id="w"/>'))
    front, back, rule = only(scene)
    assert rule is rd.Back.RADIATES
    assert front == back == pytest.approx([0.1, 0.2, 0.3])


def test_twosided_with_two_sides(load):
    dark = '<bsdf type="diffuse"><rgb name="reflectance" value="0.2"/></bsdf>'
    front, back, rule = only(load(QUAD.format(f'<bsdf type="twosided">{WHITE}{dark}</bsdf>')))
    assert (front, back, rule) == ([pytest.approx(0.7)], [pytest.approx(0.2)], rd.Back.RADIATES)


def test_an_area_emitter_emits_from_the_front_only(load):
    light = '<emitter type="area"><rgb name="radiance" value="1, 2, 3"/></emitter>'
    scene = load(QUAD.format(f'<bsdf type="twosided">{WHITE}</bsdf>{light}'))
    np.testing.assert_allclose(scene.emission, [[np.pi, 2 * np.pi, 3 * np.pi]])
    assert not scene.back_emission.any()
    np.testing.assert_allclose((scene.emission * scene.area[:, None]).sum(axis=0), 4 * np.pi * np.array([1, 2, 3]))


def test_constant_spectra_are_grey_where_all_is(load):
    light = '<emitter type="area"><spectrum name="radiance" value="2"/></emitter>'
    grey = '<bsdf type="diffuse"><spectrum name="reflectance" value="0.4"/></bsdf>'
    scene = load(QUAD.format(grey + light))
    assert scene.bands == ("grey",)
    np.testing.assert_allclose((scene.reflectance, scene.emission), ([[0.4]], [[2 * np.pi]]))


def test_constant_radiance_among_colours_is_what_mitsuba_makes_of_it(load):
    light = '<emitter type="area"><spectrum name="radiance" value="2"/></emitter>'
    scene = load(QUAD.format(WHITE + light) + QUAD.format(WHITE.replace("0.7", ".1,.2,.3")))
    import mitsuba.scalar_rgb as mi

    expected = mi.spectrum_list_to_srgb([360.0, 830.0], [2.0, 2.0], False, False)
    np.testing.assert_allclose(scene.emission[0], np.pi * np.array([float(v) for v in expected]), rtol=1e-6)


def test_sampled_spectra_become_rgb(load):
    scene = load(QUAD.format('<bsdf type="diffuse"><spectrum name="reflectance" value="400:0.1, 700:0.9"/></bsdf>'))
    np.testing.assert_allclose(scene.reflectance, [[0.7428528, 0.4811401, 0.2083246]], rtol=1e-4)  # of Mitsuba's own plugin


def test_a_missing_bsdf_is_half_and_absorbs_behind(load):
    with pytest.warns(rd.RadiosityWarning, match="no material for 'rectangle'; reflectance 0.5"):
        scene = load(QUAD.format(""))
    assert only(scene) == ([0.5], [0.5], rd.Back.ABSORBS)


@pytest.mark.parametrize(
    ("bsdf", "albedo"),
    [
        ('<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.3"/></bsdf>', 0.3),
        ('<bsdf type="roughplastic"/>', 0.5),
        ('<bsdf type="principled"><rgb name="base_color" value="0.6"/><float name="metallic" value="1"/></bsdf>', 0.6),
        ('<bsdf type="conductor"/>', 0.0),
        ('<bsdf type="roughconductor"/>', 0.0),
        ('<bsdf type="dielectric"/>', 0.0),
        (
            '<bsdf type="blendbsdf"><float name="weight" value="0.25"/><bsdf type="conductor"/><bsdf type="plastic"/></bsdf>',
            0.125,
        ),
    ],
)
def test_what_is_not_diffuse_goes_by_its_diffuse_albedo(load, bsdf, albedo):
    with pytest.warns(rd.RadiosityWarning, match="not diffuse.*'rectangle'"):
        scene = load(QUAD.format(bsdf))
    assert only(scene)[0] == [pytest.approx(albedo)]


@pytest.mark.parametrize("order", [1, -1])
def test_one_side_that_is_not_diffuse_is_named(load, order):
    plastic = '<bsdf type="plastic"><rgb name="diffuse_reflectance" value="0.3"/></bsdf>'
    sides = "".join((WHITE, plastic)[::order])
    with pytest.warns(rd.RadiosityWarning, match="not diffuse.*'rectangle'"):
        scene = load(QUAD.format(f'<bsdf type="twosided">{sides}</bsdf>'))
    assert only(scene)[:2] == tuple([[pytest.approx(0.7)], [pytest.approx(0.3)]][::order])


def test_a_blend_of_diffuse_ones_is_diffuse(load):
    dark = '<bsdf type="diffuse"><rgb name="reflectance" value="0.1"/></bsdf>'
    scene = load(QUAD.format(f'<bsdf type="blendbsdf"><float name="weight" value="0.25"/>{dark}{WHITE}</bsdf>'))
    assert only(scene)[0] == [pytest.approx(0.25)]


def test_names_are_ids_files_or_types_and_unique(load, tmp_path):
    (tmp_path / "chair.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    chair = f'<shape type="obj"><string name="filename" value="chair.obj"/>{WHITE}</shape>'
    one = f'<shape type="rectangle" id="floor">{WHITE}</shape>'
    quad = QUAD.format(WHITE)
    with pytest.warns(rd.RadiosityWarning, match=r"same name get numbers \('name 2', ...\) .*: 'chair \(2\)'$"):
        scene = load(one + chair + chair + quad + quad + f'<shape type="disk" name="lid">{WHITE}</shape>')
    assert scene.names == ("floor", "chair", "chair 2", "rectangle", "rectangle 2", "lid")


def test_emitters_that_are_not_read_are_left_out_with_one_warning(load):
    others = '<emitter type="sunsky"/><emitter type="projector"/>'
    with pytest.warns(rd.RadiosityWarning, match="left out: 'sunsky emitter', 'projector emitter'") as caught:
        load(QUAD.format(WHITE) + others)
    assert len(caught) == 1
    with pytest.raises(rd.SceneError, match="'sunsky emitter'"):
        load(QUAD.format(WHITE) + others, strict=True)


def test_parameters_includes_and_old_versions(load, tmp_path):
    (tmp_path / "more.xml").write_text(HEAD + QUAD.format(WHITE.replace("0.7", "$dark")) + TAIL)
    scene = load('<default name="dark" value="0.15"/><include filename="more.xml"/>')
    assert only(scene)[0] == [pytest.approx(0.15)]
    old = '<transform name="toWorld"><translate x="2"/></transform>'
    (tmp_path / "scene.xml").write_text(f'<scene version="0.6.0">{QUAD.format(WHITE + old)}</scene>')
    np.testing.assert_allclose(rd.load_scene(tmp_path / "scene.xml").bounds, [(1, -1, 0), (3, 1, 0)])


@pytest.mark.parametrize(
    ("fov", "vertical"),
    [
        ('<float name="fov" value="60"/>', 2 * np.degrees(np.arctan(np.tan(np.pi / 6) / 2))),
        ('<float name="fov" value="60"/><string name="fov_axis" value="y"/>', 60.0),
        ('<string name="focal_length" value="50mm"/>', 2 * np.degrees(np.arctan(np.hypot(18, 12) / 50 / np.sqrt(5)))),
    ],
)
def test_cameras(load, fov, vertical):
    film = '<film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/></film>'
    place = '<transform name="to_world"><lookat origin="1,2,3" target="1,2,0" up="0,1,0"/></transform>'
    (camera,) = load(QUAD.format(WHITE) + f'<sensor type="perspective">{fov}{film}{place}</sensor>').cameras
    assert (camera.width, camera.height) == (200, 100)
    assert camera.origin == pytest.approx((1, 2, 3))
    assert np.subtract(camera.target, camera.origin) == pytest.approx((0, 0, -1))
    assert camera.up == pytest.approx((0, 1, 0))
    assert camera.fov == pytest.approx(vertical, rel=1e-6)


@pytest.mark.parametrize("variant", ["scalar_spectral", "llvm_ad_rgb"])
def test_the_variant_of_the_user_stays(load, variant):
    import mitsuba as mi

    before = mi.variant()
    mi.set_variant(variant)
    try:
        folders = [str(folder) for folder in mi.file_resolver()]
        scene = load(QUAD.format(WHITE.replace("0.7", ".1,.2,.3")))
        assert mi.variant() == variant
        assert [str(folder) for folder in mi.file_resolver()] == folders
        np.testing.assert_allclose(scene.reflectance, [[0.1, 0.2, 0.3]])
    finally:
        if before is not None:
            mi.set_variant(before)


def test_any_variant_may_be_set(tmp_path):
    """What Mitsuba's module exports depends on the variant that a program has set; the reader must not."""
    import mitsuba

    path = tmp_path / "scene.xml"
    path.write_text(
        '<scene version="3.0.0"><shape type="rectangle"><bsdf type="diffuse"><spectrum name="reflectance" value="0.25"/></bsdf>'
        '<emitter type="area"><spectrum name="radiance" value="2"/></emitter></shape></scene>'
    )
    before = mitsuba.variant()
    found = []
    try:
        for variant in ("scalar_rgb", "scalar_spectral", "llvm_ad_rgb"):
            mitsuba.set_variant(variant)
            found.append(rd.load_scene(path))
            assert mitsuba.variant() == variant
    finally:
        if before is not None:
            mitsuba.set_variant(before)
    for scene in found:
        assert scene.reflectance.ravel() == pytest.approx([0.25])
        assert scene.emission.ravel() == pytest.approx([2 * np.pi])
