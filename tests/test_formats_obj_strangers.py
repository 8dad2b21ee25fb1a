"""OBJ and MTL files of other systems: code pages, cases of names, repeated names, and statements that make no faces."""

import numpy as np
import pytest
from samples import png

import radiosity as rd
from radiosity.errors import RadiosityWarning, SceneError
from radiosity.scene.formats.encoding import decode

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
KNOWN = "mtllib m.mtl\nusemtl grey\n"
FACE = SQUARE + KNOWN + "f 1 2 3 4\n"
CORNERS = SQUARE + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + KNOWN + "f 1/1 2/2 3/3 4/4\n"
NAMES = {
    "cp932": ["機能", "床", "天井 壁", "窓ガラス", "テーブル", "表", "白"],
    "cp950": ["成功", "地板", "牆壁", "天花板", "燈", "玻璃", "許功蓋"],
    "gb18030": ["地板", "墙壁", "天花板", "玻璃", "窗户", "木材"],
    "cp949": ["바닥", "천장", "조명", "나무"],
    "cp1252": ["Wände", "Fußboden", "café", "plafond étagère", "Mañana"],
    "cp1251": ["стена", "пол", "потолок"],
}
EACH = [(codec, name) for codec, names in NAMES.items() for name in names]


@pytest.fixture
def load(tmp_path):
    """Load OBJ text or bytes; a material ``grey`` is there."""

    def write(text, mtl="newmtl grey\nKd 0.5 0.5 0.5\n"):
        for file, data in (("x.obj", text), ("m.mtl", mtl)):
            (tmp_path / file).write_bytes(data if isinstance(data, bytes) else data.encode())
        return rd.load_scene(tmp_path / "x.obj")

    return write


def texts(load, *args):
    with pytest.warns(RadiosityWarning) as caught:
        scene = load(*args)
    return scene, [str(w.message).split(": ", 1)[1] for w in caught]


def in_code_page(name, codec):
    obj = f"mtllib m.mtl\no {name}\n{SQUARE}usemtl {name}\nf 1 2 3 4\no other {name}\nf -4 -3 -2 -1\n"
    return obj.encode(codec), f"newmtl {name}\nKd 0.2 0.2 0.2\n".encode(codec)


@pytest.mark.parametrize(("codec", "name"), EACH)
def test_names_of_code_pages(load, codec, name):
    """A last byte that is a backslash's continues no line, and the library is read as the file is; both by one warning."""
    scene, (told,) = texts(load, *in_code_page(name, codec))
    assert scene.names == (name, f"other {name}/{name}")
    assert scene.area.tolist() == [1, 1]
    assert scene.reflectance.tolist() == [[0.2], [0.2]]
    assert "not UTF-8" in told
    assert "save it as UTF-8" in told


@pytest.mark.parametrize("codec", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"])
def test_names_in_unicode(load, codec):
    marked = "\ufeff".encode("utf-16-be") if codec == "utf-16-be" else b""
    obj, mtl = in_code_page("機能 Wände", codec)
    assert load(marked + obj, marked + mtl).names == ("機能 Wände", "other 機能 Wände/機能 Wände")


def test_what_may_be_two_code_pages_is_told(load):
    _, (told,) = texts(load, *in_code_page("灯", "gb18030"))
    assert "read as GBK, or perhaps as" in told


def test_code_pages_of_comments_do_not_matter(load):
    assert load("# créé par X\n".encode("cp1252") + FACE.encode()).area.tolist() == [1]


@pytest.mark.parametrize(
    ("codec", "names"),
    [
        ("gb18030", "书架 吊扇 烤箱"),
        ("gb18030", "毛巾 相框 电视"),
        ("cp950", "書架 吊扇 烤箱"),
        ("cp950", "圍欄 汽車 道路"),
        ("cp932", "皿 植木鉢 柵"),
        ("cp932", "絨毯 引き出し 蛇口"),
        ("cp949", "책장 선풍기 오븐"),
        ("cp949", "접시 화분 울타리"),
        ("cp1252", "piñón armário chão"),
        ("cp1251", "полка духовка зеркало"),
    ],
)
def test_three_names_tell_the_code_page(codec, names):
    """Also names whose characters are none that the reader expects in rooms."""
    with pytest.warns(RadiosityWarning, match="not UTF-8"):
        assert decode(f"o {names}\n".encode(codec), "x").text == f"o {names}\n"


def test_a_library_may_be_of_another_code_page_than_the_file(load):
    scene, told = texts(load, FACE.replace("grey", "Wände"), "newmtl Wände\nKd 0.3 0.3 0.3\n".encode("cp1252"))
    assert scene.reflectance.tolist() == [[0.3]]
    assert len(told) == 1


def test_marks_that_do_not_go_on_are_damage(tmp_path):
    (tmp_path / "x.obj").write_bytes(b"\xff\xfev\0 ")
    with pytest.raises(SceneError, match=r"x\.obj: begins as UTF-16 text does.*damaged"):
        rd.load_scene(tmp_path / "x.obj")


def test_a_very_long_line_is_looked_through_once(recwarn):
    """Looking for a byte from each place of the line on would take hours."""
    assert len(decode(b"a" * 2_000_000 + b"\n\xe9\n", "x").text) == 2_000_003


def test_bytes_that_no_code_page_has_do_not_end_the_reader(recwarn):
    assert decode(b"o a\x81\x8d\xff\xff b\n", "x").text.startswith("o a")


def test_colours_in_xyz_are_converted_and_told(load):
    scene, (told,) = texts(load, FACE, "newmtl grey\nKd xyz 0.4 0.5 0.3\nKe xyz 2\n")
    assert "XYZ" in told
    assert "'grey'" in told
    np.testing.assert_allclose(scene.emission, 2 * np.pi)  # one number stands for all three: equal energy is grey
    weights = np.array([0.265, 0.670, 0.065])  # luminance of Radiance's primaries
    assert scene.reflectance[0] @ weights == pytest.approx(0.5, abs=1e-3)
    assert scene.reflectance[0, 1] > scene.reflectance[0, 0] > scene.reflectance[0, 2]


def test_spectral_curves_are_told(load):
    scene, told = texts(load, FACE, "newmtl grey\nKd spectral paint.rfl 0.5\n")
    assert told == [
        "colours that are spectral curves (.rfl) are not read, write them as red, green and blue: 'grey'",
        "no material for 'x/grey'; reflectance 0.5 taken",
    ]
    assert scene.reflectance.tolist() == [[0.5]]


def test_of_materials_defined_twice_the_last_holds_alone(load):
    mtl = "newmtl grey\nKd 0.2 0.2 0.2\nKe 1 1 1\nnewmtl grey\nKd 0.3 0.3 0.3\n"
    scene, told = texts(load, FACE, mtl)
    assert told == ["materials that are defined again; the last definition holds: 'grey'"]
    assert (scene.reflectance.item(), scene.emission.item()) == (0.3, 0)


def test_of_libraries_with_equal_materials_the_last_holds(load, tmp_path):
    (tmp_path / "n.mtl").write_text("newmtl grey\nKd 0.3 0.3 0.3\n")
    scene, told = texts(load, FACE.replace("m.mtl", "m.mtl n.mtl"))
    assert told == ["materials that several libraries define; the last one holds: 'grey'"]
    assert scene.reflectance.item() == 0.3


def test_textures_and_libraries_of_other_case_are_found_and_told(load, tmp_path):
    (tmp_path / "Pictures").mkdir()
    (tmp_path / "Pictures" / "Wood.PNG").write_bytes(png(np.full((4, 4, 3), 120)))
    mtl = "newmtl grey\nKd 1 1 1\nmap_Kd pictures\\wood.png\n"
    scene, told = texts(load, CORNERS.replace("m.mtl", "M.MTL"), mtl)
    assert told == [
        "files whose names differ in case: 'pictures/wood.png (it is Wood.PNG)'; other systems may not find them",
        "files whose names differ in case: 'M.MTL (it is m.mtl)'; other systems may not find them",
    ]
    np.testing.assert_allclose(rd.subdivide(scene, cells=1).reflectance, ((120 / 255 + 0.055) / 1.055) ** 2.4, rtol=1e-6)


def test_the_case_of_a_name_leads_nowhere_else(load, tmp_path):
    """Not out of the folder, and to none of several."""
    (tmp_path / "WOOD.png").write_bytes(png(np.full((4, 4, 3), 120)))
    (tmp_path / "Wood.png").write_bytes(png(np.full((4, 4, 3), 220)))
    if len(list(tmp_path.glob("*.png"))) == 2:  # a system that tells cases apart
        with pytest.warns(RadiosityWarning, match="textures that cannot be read"):
            load(CORNERS, "newmtl grey\nKd 0.5 0.5 0.5\nmap_Kd wood.png\n")
    with pytest.warns(RadiosityWarning, match="textures that cannot be read"):
        load(CORNERS, "newmtl grey\nKd 0.5 0.5 0.5\nmap_Kd ../GONE/gone.png\n")


def test_objects_of_the_same_name_become_one_and_are_told(load):
    scene, told = texts(load, SQUARE + KNOWN + "o a\nf 1 2 3\no a\nf 1 3 4\n")
    assert told[0] == "objects of the same name become one: 'a (2)'"
    assert scene.names == ("a/grey",)


def test_groups_may_be_taken_up_again(load):
    text = SQUARE + "v 2 0 0\nv 2 1 0\n" + KNOWN + "g a\nf 1 2 3\ng b\nf 2 5 6 3\ng a\nf 1 3 4\n"
    assert load(text).names == ("a/grey", "b/grey")


def test_points_lines_and_unknown_statements_are_told_once(load):
    scene, told = texts(load, FACE + "p 1\nl 1 2\nl 2 3\ncall other.obj\nvn 0 0 1\ns 1\n")
    assert told == ["statements that are left out: 'points (1)', 'lines (2)', 'call (1)'"]
    assert scene.area.tolist() == [1]


def test_transparency_by_a_texture_displacements_and_decals_are_told(load):
    mtl = "newmtl grey\nKd 0.5 0.5 0.5\nmap_d net.png\ndisp d.png\ndecal e.png\nmap_Bump b.png\nmap_Ks s.png\n"
    _, told = texts(load, FACE, mtl)
    assert told == [
        "displacements (disp) are left out: 'grey'",
        "decals (decal) are left out: 'grey'",
        "transparency is left out, taken as opaque: 'grey'; transmittance in a .toml makes panes",
    ]
