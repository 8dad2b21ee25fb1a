"""A scene file is data: nothing in it is run, nothing outside its folder is read, and sizes that it announces are not
believed."""

import io
import json
import os
import sys
import zipfile

import numpy as np
import pytest
from samples import HALVES, SQUARE, Gltf, png

import radiosity as rd
from radiosity.cli.app import run as command

SECRET = "outside"


@pytest.fixture
def folder(tmp_path):
    """A scene's folder, with files beside it that are none of its business."""
    (tmp_path / "scene").mkdir()
    (tmp_path / SECRET).mkdir()
    outside = tmp_path / SECRET
    (outside / "part.mgf").write_text("m grey =\n rd .5\nv a =\n p 0 0 0\nv b =\n p 1 0 0\nv c =\n p 0 1 0\nf a b c\n")
    (outside / "wall.mtl").write_text("newmtl wall\nKd .5 .5 .5\n")
    (outside / "wall.png").write_bytes(png(np.full((4, 4, 3), 128)))
    (outside / "square.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    (outside / "square.bin").write_bytes(square().data)
    (outside / "more.xml").write_text('<scene version="3.0.0"><shape type="rectangle"/></scene>')
    return tmp_path / "scene"


def obj(folder, mtl: str, library: str = "") -> None:
    (folder / "s.obj").write_text(
        f"mtllib {library or 'own.mtl'}\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl wall\nf 1/1 2/2 3/3\n"
    )
    (folder / "own.mtl").write_text("newmtl wall\n" + mtl)


def xml(folder, inside: str) -> None:
    (folder / "s.xml").write_text(f'<scene version="3.0.0">{inside}</scene>')


def square() -> Gltf:
    builder = Gltf()
    mesh = builder.accessor(SQUARE), builder.accessor(np.ravel(HALVES), "u2")
    builder.tree["meshes"].append({"primitives": [{"attributes": {"POSITION": mesh[0]}, "indices": mesh[1]}]})
    builder.tree["nodes"].append({"mesh": 0})
    return builder


def gltf(folder, uri: str) -> None:
    builder = square()
    builder.tree["buffers"] = [{"byteLength": len(builder.data), "uri": uri}]
    (folder / "s.gltf").write_text(json.dumps(builder.tree))


PICTURE = (
    '<shape type="rectangle"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">'
    '<string name="filename" value="%s"/></texture></bsdf></shape>'
)
OUTSIDE = {
    "mgf include": lambda f, p: (f / "s.mgf").write_text(f"i {p('part.mgf')}\n"),
    "obj library": lambda f, p: obj(f, "Kd 1 1 1\n", p("wall.mtl")),
    "obj texture": lambda f, p: obj(f, f"map_Kd {p('wall.png')}\n"),
    "ply texture": lambda f, p: (f / "s.ply").write_text(
        f"ply\nformat ascii 1.0\ncomment TextureFile {p('wall.png')}\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nproperty float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\n"
        "end_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n3 0 1 2\n"
    ),
    "xml include": lambda f, p: xml(f, f'<include filename="{p("more.xml")}"/>'),
    "xml mesh": lambda f, p: xml(f, f'<shape type="obj"><string name="filename" value="{p("square.obj")}"/></shape>'),
    "xml picture": lambda f, p: xml(f, PICTURE % p("wall.png")),
    "xml path": lambda f, p: xml(
        f, f'<path value="{p(".")}"/><shape type="obj"><string name="filename" value="square.obj"/></shape>'
    ),
    "gltf buffer": lambda f, p: gltf(f, p("square.bin").replace("..", "%2e%2e")),
    "toml geometry": lambda f, p: (f / "s.toml").write_text(f'[[geometry]]\nfile = "{p("square.obj")}"\n'),
}
NEEDS = {"mgf include": "pyradiance", "toml geometry": "pydantic"}


def made(folder, kind, path):
    if kind in NEEDS:
        pytest.importorskip(NEEDS[kind])
    OUTSIDE[kind](folder, path)
    return next(folder.glob("s.*"))


@pytest.mark.filterwarnings("ignore::radiosity.RadiosityWarning")
@pytest.mark.parametrize("kind", OUTSIDE)
def test_files_outside_the_folder_are_refused_unless_allowed(folder, kind):
    scene = made(folder, kind, lambda name: f"../{SECRET}/{name}")
    with pytest.raises(rd.SceneError, match=r"outside the scene's folder.*--allow-outside"):
        rd.load_scene(scene)
    assert rd.load_scene(scene, allow_outside=True).n_faces >= 1


@pytest.mark.parametrize("kind", ["mgf include", "obj texture", "xml mesh", "toml geometry"])
def test_links_are_followed_before_they_are_judged(folder, kind):
    (folder / "link").symlink_to(folder.parent / SECRET)
    scene = made(folder, kind, lambda name: f"link/{name}")
    with pytest.raises(rd.SceneError, match="outside the scene's folder"):
        rd.load_scene(scene)


@pytest.mark.filterwarnings("ignore::radiosity.RadiosityWarning")
def test_absolute_paths_into_the_folder_are_fine(folder):
    (folder / "wall.png").write_bytes(png(np.full((4, 4, 3), 128)))
    obj(folder, f"map_Kd {folder / 'wall.png'}\n")
    assert rd.load_scene(folder / "s.obj").reflectance_paint is not None


@pytest.mark.parametrize("kind", ["obj texture", "xml picture"])
def test_through_the_command_line(folder, kind, capsys):
    scene = made(folder, kind, lambda name: f"../{SECRET}/{name}")
    assert command(["check", str(scene)]) == 1
    assert "--allow-outside" in capsys.readouterr().out
    assert command(["solve", str(scene), "--rays", "1000"]) == 2
    assert "--allow-outside" in capsys.readouterr().err


@pytest.mark.parametrize("uri", ["http://127.0.0.1:9/a.bin", "https://example.org/a.bin", "file:///etc/passwd", "ftp://a/b"])
def test_nothing_is_fetched(folder, uri):
    gltf(folder, uri)
    with pytest.raises(rd.SceneError, match="nothing is fetched"):
        rd.load_scene(folder / "s.gltf", allow_outside=True)


@pytest.mark.parametrize("line", ["!touch {canary}", "! touch {canary}", "i |touch${{IFS}}{canary}", "ies `touch {canary}`"])
@pytest.mark.filterwarnings("ignore::radiosity.RadiosityWarning")
def test_no_line_of_an_mgf_file_runs_a_command(tmp_path, line):
    pytest.importorskip("pyradiance")
    canary = tmp_path / "canary"
    text = "v a =\n p 0 0 0\nv b =\n p 1 0 0\nv c =\n p 0 1 0\nf a b c\n"
    (tmp_path / "s.mgf").write_text(line.format(canary=canary) + "\n" + text)
    if line.startswith("!"):
        with pytest.raises(rd.SceneError, match=r"s\.mgf:1: .*would run a command"):
            rd.load_scene(tmp_path / "s.mgf")
    else:
        assert rd.load_scene(tmp_path / "s.mgf").n_faces == 1
    assert not canary.exists()


@pytest.mark.parametrize("line", ["!touch {canary}", "  ! touch {canary}", "void plastic a 0 0 0\n!touch {canary}"])
def test_no_line_of_a_radiance_scene_runs_a_command(tmp_path, line):
    canary = tmp_path / "canary"
    (tmp_path / "s.rad").write_text(line.format(canary=canary) + "\n")
    with pytest.raises(rd.SceneError, match=r"s\.rad:[12]: .*would run a command"):
        rd.load_scene(tmp_path / "s.rad")
    assert not canary.exists()


LAUGHS = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 12))


@pytest.mark.parametrize(
    "head",
    [
        f'<!DOCTYPE scene [<!ENTITY l0 "ha">{LAUGHS}]>',
        '<!DOCTYPE scene [<!ENTITY x SYSTEM "file:///etc/passwd">]>',
        '<!DOCTYPE scene SYSTEM "http://127.0.0.1:9/a.dtd">',
    ],
)
def test_entities_are_not_expanded(tmp_path, head):
    (tmp_path / "s.xml").write_text(f'<?xml version="1.0"?>{head}<scene version="3.0.0"><shape type="rectangle"/></scene>')
    with pytest.raises(rd.SceneError, match="document type"):
        rd.load_scene(tmp_path / "s.xml")


def test_includes_that_never_end(tmp_path):
    (tmp_path / "s.xml").write_text('<scene version="3.0.0"><include filename="s.xml"/></scene>')
    with pytest.raises(rd.SceneError):
        rd.load_scene(tmp_path / "s.xml")


# ---- solutions -----------------------------------------------------------------------------------------------------------


class Bomb:
    def __init__(self, canary):
        self.canary = canary

    def __reduce__(self):
        return os.mkdir, (str(self.canary),)


def test_pickles_in_a_solution_are_not_opened(tmp_path):
    canary = tmp_path / "canary"
    np.savez(tmp_path / "a.npz", meta=np.array([Bomb(canary)], object))
    with pytest.raises(rd.SceneError, match="Python objects"):
        rd.load_solution(tmp_path / "a.npz")
    assert not canary.exists()


def member(shape, data=b"") -> bytes:
    file = io.BytesIO()
    np.lib.format.write_array_header_1_0(file, {"descr": "<f8", "fortran_order": False, "shape": shape})
    return file.getvalue() + data


def test_sizes_are_compared_with_the_file_s_length(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("meta.npy", member((1 << 40,), b"\0" * 64))
    with pytest.raises(rd.SceneError, match="announces 8,796,093,022,208 bytes and holds 64"):
        rd.load_solution(tmp_path / "a.npz")
    with zipfile.ZipFile(tmp_path / "b.npz", "w") as archive:
        archive.writestr("meta.npy", member((8,), b"\0" * 65))
    with pytest.raises(rd.SceneError, match="announces 64 bytes and holds 65; the file is damaged"):
        rd.load_solution(tmp_path / "b.npz")


def test_archives_that_unpack_to_very_much(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("meta.npy", member((1 << 23,), b"\0" * (8 << 23)))
    with pytest.raises(rd.SceneError, match="would unpack to 67,108"):
        rd.load_solution(tmp_path / "a.npz")


def test_compressed_solutions_are_still_read(tmp_path):
    solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=4), "random-walk", rays=20_000)
    solution.save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as file:
        np.savez_compressed(tmp_path / "b.npz", **file)
    assert np.array_equal(rd.load_solution(tmp_path / "b.npz").irradiance, solution.irradiance)


def test_characters_that_are_none(tmp_path):
    """Numpy takes any four bytes for a character; Python fails on it much later, when a name is printed."""
    rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), "random-walk", rays=2_000).save(tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz") as file:
        arrays = dict(file)
    codes = np.frombuffer(arrays["meta"].tobytes(), np.uint32).copy()
    codes[str(arrays["meta"]).index("floor")] = 0x110000
    arrays["meta"] = np.frombuffer(codes.tobytes(), arrays["meta"].dtype)[0:1].reshape(())
    np.savez(tmp_path / "b.npz", **arrays)
    with pytest.raises(rd.SceneError, match="meta is no text"):
        rd.load_solution(tmp_path / "b.npz")


# ---- names ---------------------------------------------------------------------------------------------------------------

NAMES = ["two words", 'it\'s "quoted"', "100 %s %d", "-rf", "Größe 壁", "a\nb", "[red]x[/red]", "x\x1b[2J\x07y", "=1+1", "{0}"]


@pytest.mark.filterwarnings("ignore::radiosity.RadiosityWarning")
@pytest.mark.usefixtures("small_pictures")
@pytest.mark.parametrize("name", NAMES)
def test_names_of_files_and_surfaces(tmp_path, name, capsys):
    folder = tmp_path / name.replace("/", "")
    folder.mkdir()
    surface = name.replace("\n", " ")
    stem = name.replace("/", "")
    (folder / f"{stem}.obj").write_text(
        f"mtllib {stem}.mtl\no {surface}\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"
        if "\n" not in name
        else f"o {surface}\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
        encoding="utf-8",
    )
    if "\n" not in name:
        (folder / f"{stem}.mtl").write_text("newmtl m\nKd .5 .5 .5\nKe 1 1 1\n")
        outputs = [str(folder / f"{stem}.{kind}") for kind in ("npz", "glb", "ply", "vtp", "csv", "png")]
        assert command(["solve", str(folder / f"{stem}.obj"), "--rays", "2000", "--cells", "2", "-o", *outputs]) == 0
        assert rd.load_solution(outputs[0]).patches.scene.names[0].startswith(" ".join(surface.split()))
        assert all(os.path.getsize(output) for output in outputs)
    command(["check", str(folder / f"{stem}.obj")])
    shown = capsys.readouterr()
    assert "\x1b" not in shown.out + shown.err
    assert "\x07" not in shown.out + shown.err
    command(["solve", str(folder / f"{stem}.missing.obj")])
    assert "\x1b" not in capsys.readouterr().err


def test_scenes_in_a_folder_that_begins_with_a_dash(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "-x.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    with pytest.warns(rd.RadiosityWarning):
        assert rd.load_scene("-x.obj").n_faces == 1


@pytest.mark.parametrize(
    ("does", "says"),
    [
        ("import time; time.sleep(0.5); bytearray(3 << 30)", "mgfilt cannot read"),
        ("while True: pass", "did not finish|signal"),
        ("import os; print(sorted(os.environ))", "mgfilt|no face"),
    ],
)
def test_the_program_that_reduces_mgf_is_bounded(monkeypatch, tmp_path, does, says):
    """In memory, in time; and it sees nothing of the environment."""
    from radiosity.scene.formats.mgf import filter as mgf

    (tmp_path / "mgfilt").write_text(f"#!{sys.executable} -I\n{does}\n")
    (tmp_path / "mgfilt").chmod(0o755)
    (tmp_path / "s.mgf").write_text("v a =\n p 0 0 0\nv b =\n p 1 0 0\nv c =\n p 0 1 0\nf a b c\n")
    monkeypatch.setattr(mgf, "program", lambda name: str(tmp_path / "mgfilt"))
    monkeypatch.setattr(mgf, "MOST_MEMORY", 2 << 30)
    monkeypatch.setattr(mgf, "SECONDS", 2)
    with pytest.raises(rd.SceneError, match=says):
        rd.load_scene(tmp_path / "s.mgf")
