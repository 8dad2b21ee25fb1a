"""Files that a scene names in another case than they have are found and told, in every format that names files."""

import json

import numpy as np
import pytest
from samples import OBJ, SQUARE, Gltf, ply_text, png

import radiosity as rd

GREY = {"name": "grey", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}}


def gltf(folder):
    one = Gltf()
    one.node(mesh=one.mesh(material=GREY))
    (folder / "Data.BIN").write_bytes(one.data)
    tree = {**one.tree, "buffers": [{"byteLength": len(one.data), "uri": "data.bin"}]}
    (folder / "x.gltf").write_text(json.dumps(tree))
    return "x.gltf", "data.bin (it is Data.BIN)"


def mitsuba(folder):
    (folder / "Meshes").mkdir()
    (folder / "Meshes" / "Tile.ply").write_text(ply_text())
    shape = '<shape type="ply"><string name="filename" value="meshes\\tile.ply"/><bsdf type="diffuse"/></shape>'
    (folder / "x.xml").write_text(f'<scene version="3.0.0">{shape}</scene>')
    return "x.xml", "meshes/tile.ply (it is Tile.ply)"


def toml(folder):
    (folder / "Tile.PLY").write_text(ply_text())
    (folder / "x.toml").write_text('geometry = "tile.ply"\n[[surface]]\nname = "*"\nreflectance = 0.5\n')
    return "x.toml", "tile.ply (it is Tile.PLY)"


def mgf(folder):
    rows = "".join(f"v {name} =\n\tp {x} {y} {z}\n" for name, (x, y, z) in zip("abcd", SQUARE, strict=True))
    (folder / "Tile.MGF").write_text(f"m grey =\n\trd 0.5\n{rows}f a b c d\n")
    (folder / "x.mgf").write_text("i tile.mgf\n")
    return "x.mgf", "tile.mgf (it is Tile.MGF)"


def obj(folder):
    (folder / "Box.MTL").write_text("newmtl white\nKd 0.5 0.5 0.5\nmap_Kd WALL.png\nnewmtl light\nKd 0 0 0\n")
    (folder / "wall.png").write_bytes(png(np.full((2, 2, 3), 120)))
    (folder / "x.obj").write_text(OBJ)
    return "x.obj", "box.mtl (it is Box.MTL)"


@pytest.mark.parametrize("write", [gltf, mitsuba, toml, mgf, obj])
def test_files_of_other_case(tmp_path, write):
    name, told = write(tmp_path)
    with pytest.warns(rd.RadiosityWarning) as caught:
        scene = rd.load_scene(tmp_path / name)
    assert f"'{told}'" in " ".join(str(w.message) for w in caught)
    assert all("differ in case" in str(w.message) for w in caught)
    assert (scene.area == 1).all()
    assert not (scene.reflectance == 0.95).any()
