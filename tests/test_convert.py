"""Scenes written to files read back as the same scenes, and what a format cannot hold is told by name."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

import radiosity as rd
from radiosity.cli import main
from radiosity.cli.app import ARGUMENTS, app
from radiosity.conversion import webs
from radiosity.scene.paint import Paint
from radiosity.scene.sampler import Sampler

BUILTIN = ("cornell-box", "room", "studio", "labyrinth-0.5")
EXACT, SINGLE = 1e-15, 2e-6  # relative: of files with all digits, and of 32-bit coordinates


def again(scene: rd.Scene, path) -> tuple[rd.Scene, list[str]]:
    """The scene after it was written and read, and the warnings."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        rd.save_scene(scene, path)
        read = rd.load_scene(path, max_reflectance=0.9999)
    return read, [str(one.message) for one in told]


def sides(scene: rd.Scene) -> dict:
    """What radiates: by surface area, reflected share of it and power of all sides that do; backs of their own count as such."""
    result: dict = {}
    radiates = scene.back == rd.Back.RADIATES
    parts = [(slice(None), "", scene.reflectance, scene.emission), (radiates, "", scene.back_reflectance, scene.back_emission)]
    for some, _, reflectance, emission in parts:
        for surface in np.unique(scene.surface[some]):
            rows = np.flatnonzero(np.isin(np.arange(scene.n_faces), np.arange(scene.n_faces)[some]) & (scene.surface == surface))
            name = scene.names[surface].split(".")[0].removesuffix(" (back)")
            area = scene.area[rows, None]
            held = np.concatenate([[area.sum()], (area * reflectance[rows]).sum(axis=0), (area * emission[rows]).sum(axis=0)])
            result[name] = result.get(name, 0) + held
    return result


def check_same(scene: rd.Scene, read: rd.Scene, tolerance: float) -> None:
    one, other = sides(scene), sides(read)
    assert one.keys() == other.keys()
    for name, values in one.items():
        bands = (len(other[name]) - 1) // 2
        assert other[name] == pytest.approx(values if bands == scene.n_bands else values[[0, 1, -1]], rel=tolerance, abs=1e-12)


@pytest.mark.parametrize("suffix", [".toml", ".glb", ".gltf"])
@pytest.mark.parametrize("name", BUILTIN)
def test_built_in_scenes_read_back_as_they_are(name, suffix, tmp_path):
    scene = rd.load_scene(name)
    read, told = again(scene, tmp_path / f"scene{suffix}")
    check_same(scene, read, 1e-12 if suffix == ".toml" else SINGLE)
    assert any("surfaces of their own" in text for text in told)  # the backs of their lamps
    assert len(read.cameras) == len(scene.cameras)
    for one, other in zip(scene.cameras, read.cameras, strict=True):
        assert other.fov == pytest.approx(one.fov)
        assert other.width / other.height == pytest.approx(one.width / one.height, rel=2e-3)
    if suffix == ".toml":
        assert np.array_equal(read.bounds, scene.bounds)
        assert read.cameras == scene.cameras


def test_light_is_the_same_after_the_way_through_a_file(tmp_path):
    scene = rd.load_scene("room")
    read, _ = again(scene, tmp_path / "room.glb")
    before, after = (rd.solve(rd.subdivide(one, cells=2), rays=100_000, seed=seed) for seed, one in enumerate((scene, read)))
    found = rd.compare(before, after)
    assert found.agrees, found.report()
    assert len(found.rows.surface) == 9  # of the light its front: its back is a surface of its own in one of the scenes


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".stl"])
def test_what_meshes_cannot_hold_is_told(suffix, tmp_path):
    scene = rd.load_scene("studio")
    read, told = again(scene, tmp_path / f"x{suffix}")
    assert read.area.sum() == pytest.approx(scene.area.sum(), rel=SINGLE)
    text = "\n".join(told)
    for words in ("read back as two-sided: 'south wall'", "cameras are left out: 'camera 0'", "patch sizes are left out"):
        assert words in text
    assert ("names" in text) == (suffix != ".obj")
    assert ("emission is left out: 'lantern', 'lamp'" in text) == (suffix != ".obj")
    assert ("shining alike to both: 'lantern', 'lamp'" in text) == (suffix == ".obj")
    assert ("reflectances are left out" in text) == (suffix == ".stl")
    if suffix != ".stl":
        total = [
            (s.area[:, None] * s.reflectance * (1 if s.reflectance_paint is None else s.reflectance_paint.color[:, 0]))
            for s in (scene, read)
        ]
        assert total[1].sum(axis=0) == pytest.approx(total[0].sum(axis=0), rel=1e-5)


NAMES = st.text(st.characters(codec="utf-8", exclude_categories=["Cs", "Cc"]), min_size=1, max_size=8)
SHARE = st.floats(0, 0.95)


@st.composite
def scenes(draw) -> rd.Scene:
    """A few parallelograms and triangles apart from each other, of all sides, colours and lights."""
    count, bands = draw(st.integers(1, 5)), draw(st.sampled_from([1, 3]))
    corners, faces = [], []
    for i in range(count):
        base = np.array([3.0 * i, draw(st.floats(-50, 50)), draw(st.floats(-2, 2))])
        one, two = np.array([draw(st.floats(0.1, 2)), 0.3, 0]), np.array([0.1, draw(st.floats(0.1, 2)), draw(st.floats(-1, 1))])
        quad = draw(st.booleans())
        start = len(corners)
        corners += [base, base + one, base + one + two, base + two] if quad else [base, base + one, base + two]
        faces.append([start, start + 1, start + 2, start + 3 if quad else -1])
    names = draw(st.lists(NAMES, min_size=count, max_size=count, unique_by=lambda name: " ".join(name.split()).lower()))
    values = st.lists(st.lists(SHARE, min_size=bands, max_size=bands), min_size=count, max_size=count)
    reflectance = np.array(draw(values))
    transmittance = np.array(draw(st.lists(st.sampled_from([0.0, 0.0, 0.6]), min_size=count, max_size=count)))
    backs = draw(st.lists(st.sampled_from([0, 1]), min_size=count, max_size=count))
    backs = np.where(transmittance > 0, 1, backs)
    return rd.Scene.from_arrays(
        corners,
        faces,
        reflectance * (1 - transmittance[:, None]) * 0.9,
        100 * np.array(draw(values)),
        surface=np.arange(count),
        names=names,
        back=backs,
        transmittance=transmittance,
        bands=None if bands == 1 else ("red", "green", "blue"),
        photometric=draw(st.booleans()),
    )


@given(scenes(), st.sampled_from([".toml", ".glb", ".obj"]))
@hypothesis_settings(max_examples=25, deadline=None)
def test_scenes_of_all_kinds_read_back(tmp_path_factory, scene, suffix):
    """Values to the last digits, in the order of the surfaces; names too, unless it is told that they change."""
    read, told = again(scene, tmp_path_factory.mktemp("scene") / f"x{suffix}")
    assert read.n_faces == scene.n_faces
    order = np.argsort(read.surface)
    darker = any("become darker" in text for text in told)
    for key in ("reflectance", "emission"):
        values, found = getattr(scene, key), getattr(read, key)[order]
        if read.n_bands < scene.n_bands:  # all of it is grey
            assert (values == values[:, :1]).all()
        if not (darker and key == "reflectance"):
            assert found == pytest.approx(values[:, : read.n_bands], rel=1e-9, abs=1e-12), key
    assert read.area[order] == pytest.approx(scene.area, rel=1e-4 if suffix == ".glb" else 1e-12)
    if suffix != ".obj":
        assert (read.back[order] == scene.back).all()
        assert read.panes[order].tolist() == scene.panes.tolist()
        if suffix == ".toml":
            assert read.photometric == scene.photometric
            assert scene.transmittance is None or np.array_equal(read.transmittance[order], scene.transmittance)
    if not any("are changed" in text for text in told):
        assert read.names == scene.names


def test_a_pane_keeps_what_it_lets_through(tmp_path):
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], 0.08, 0, two_sided=True, transmittance=0.8, names=["pane"])
    read, _ = again(scene, tmp_path / "x.glb")
    assert read.transmittance == pytest.approx([0.8])
    assert read.reflectance == pytest.approx(np.array([[0.08]]))
    _, told = again(replace(scene, transmittance=np.array([0.91])), tmp_path / "y.glb")
    assert any("become darker: 'pane'" in text for text in told)


@pytest.mark.parametrize("clear", [0.0, 0.3])
@pytest.mark.parametrize("suffix", [".glb", ".toml", ".obj"])
def test_a_diffusing_pane_stays_one_or_is_named(suffix, clear, tmp_path):
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    bands = ("red", "green", "blue")
    through = {"transmittance": clear, "diffuse_transmittance": [[0.3, 0.2, 0.1]]}
    scene = rd.Scene.from_arrays(
        corners, [[0, 1, 2, 3]], [[0.2, 0.15, 0.2]], 0, two_sided=True, names=["pane"], bands=bands, **through
    )
    read, told = again(scene, tmp_path / f"x{suffix}")
    if suffix == ".obj":
        assert any("become opaque: 'pane'" in text for text in told)
        return
    assert read.diffuse_transmittance == pytest.approx(scene.diffuse_transmittance)
    assert read.reflectance == pytest.approx(scene.reflectance)
    assert (read.transmittance is None) == (clear == 0)
    assert clear == 0 or read.transmittance == pytest.approx([clear])


def test_lamps_without_area_are_kept_or_named(tmp_path):
    lamps = [
        rd.point_light(position=(1, 1, 2), lumens=800, name="globe", color=(1, 0.5, 0.25)),
        rd.point_light(position=(2, 1, 2), intensity=500, beam=30, name="gauss"),
    ]
    room = rd.load_scene("room")
    scene = replace(room, photometric=True).with_lights(lamps, suns=[rd.sun(50_000, direction=(0, 1, 1), diameter=0)])
    for suffix in (".toml", ".glb"):
        read, told = again(scene, tmp_path / f"x{suffix}")
        (lamp,) = read.lights.luminaires
        assert lamp.power == pytest.approx(lamps[0].power)
        assert any("gauss" in text and "left out" in text for text in told)
        (sun,) = read.lights.suns
        assert sun.irradiance == pytest.approx([50_000] * len(sun.irradiance))
        assert read.photometric
        turned = suffix == ".glb"  # z-up becomes y-up
        assert lamp.position == pytest.approx([1, 2, -1] if turned else [1, 1, 2])
        assert sun.direction * 2**0.5 == pytest.approx([0, 1, -1] if turned else [0, 1, 1], abs=1e-6)


def test_a_uniform_sky_and_openings_stay_in_a_toml(tmp_path):
    window = np.array([[0.0, 0, 1], [1, 0, 1], [1, 0, 2], [0, 0, 2]])
    scene = rd.load_scene("room")
    scene = replace(scene, photometric=True).with_lights(sky=rd.uniform_sky(5000, name="haze"), openings=[window])
    read, told = again(scene, tmp_path / "x.toml")
    assert read.lights.sky.name == "haze"
    assert read.lights.sky.horizontal == pytest.approx([5000])
    assert read.lights.openings == pytest.approx(scene.lights.openings)
    _, told = again(replace(scene, lights=replace(scene.lights, sky=rd.cie_sky("overcast", 5000))), tmp_path / "y.toml")
    assert any("skies that are not uniform are left out" in text for text in told)


def test_a_spot_of_gltf_is_one_again(tmp_path):
    from radiosity.scene.lights.webs import cone

    inner, outer = np.radians([20, 35])
    shape = lambda angle: np.clip((np.cos(angle) - np.cos(outer)) / (np.cos(inner) - np.cos(outer)), 0, 1) ** 2  # noqa: E731
    lamp = replace(rd.point_light(position=(1, 1, 2), lumens=100, name="spot"), web=cone(20, 35, shape))
    assert webs.cone(lamp) == pytest.approx((inner, outer), rel=1e-3)
    read, _ = again(replace(rd.load_scene("room"), photometric=True).with_lights([lamp]), tmp_path / "x.gltf")
    assert read.lights.luminaires[0].power == pytest.approx(lamp.power, rel=1e-3)


@pytest.mark.parametrize("suffix", [".glb", ".toml"])
def test_textures_stay_where_they_are(suffix, tmp_path):
    """A face with an image of four colours: the means of its patches are the same after the way through a file."""
    codes = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [128, 128, 128]]]) / 255
    image = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4).astype(np.float32)
    corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    bands = ("red", "green", "blue")
    plain = rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], [[0.8, 0.6, 0.4]], 0, names=["picture"], two_sided=True, bands=bands)
    uv = np.array([[[0, 0], [1, 0], [1, 1], [0, 1]]], np.float32)
    paint = Paint(
        (image,), np.zeros(1, np.int32), uv, np.ones((1, 4, 3), np.float32), 0.95, (Sampler(("clamp",) * 2, "nearest"),)
    )
    scene = replace(plain, reflectance_paint=paint)
    read, _ = again(scene, tmp_path / f"x{suffix}")
    before, after = (rd.subdivide(one, cells=2) for one in (scene, read))
    assert len(np.unique(before.reflectance.round(3), axis=0)) == 4
    after_at = after.centroid[:, [0, 2, 1]] * [1, -1, 1] if suffix == ".glb" else after.centroid  # z-up again
    where = [
        np.argmin(np.linalg.norm(after_at - point, axis=1) + (after.is_back != back))
        for point, back in zip(before.centroid, before.is_back, strict=True)
    ]
    assert after.reflectance[where] == pytest.approx(before.reflectance, abs=1e-6)
    _, told = again(scene, tmp_path / "x.obj")
    assert any("in place of" in text or "take the place of textures" in text for text in told)


def test_heat_sensors_and_patch_sizes_stay_in_a_toml(tmp_path):
    (tmp_path / "room.obj").write_text("o floor\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")
    (tmp_path / "room.toml").write_text(
        'geometry = "room.obj"\nsurroundings = 290.0\n[[surface]]\nname = "floor"\ntemperature = 310.0\nemissivity = 0.9\n'
        'patch_size = 0.25\nback = "passes"\n[[sensors]]\nname = "desk"\nsurface = "floor"\nheight = 0.8\nspacing = 0.5\n'
        '[[sensors]]\nname = "eye"\npoints = [[0.5, 0.5, 1.2]]\nkind = "cylindrical"\n'
    )
    scene = rd.load_scene(tmp_path / "room.toml")
    read, told = again(scene, tmp_path / "again.toml")
    assert not told
    assert read.heat.facts() == scene.heat.facts()
    assert read.sensors == scene.sensors
    assert read.patch_size.tolist() == scene.patch_size.tolist()
    assert read.back.tolist() == scene.back.tolist()
    assert read.hash == scene.hash


def test_the_command_converts_scenes_and_solutions(tmp_path, capsys):
    solution = rd.solve(rd.subdivide(rd.load_scene("room"), cells=1), rays=20_000)
    solution.save(tmp_path / "room.npz")
    source = str(tmp_path / "room.npz")
    assert main(["convert", source, *(str(tmp_path / name) for name in ("a.csv", "a.vtp", "b.toml"))]) == 0
    assert (tmp_path / "a.surfaces.csv").exists()
    assert main(["convert", source, str(tmp_path / "scene.glb"), "--scene"]) == 0
    assert rd.load_scene(tmp_path / "scene.glb").emission.max() == pytest.approx(solution.patches.emission.max(), rel=1e-6)
    capsys.readouterr()
    for wrong, says in (
        ([], "no output"),
        ([source], "written over"),
        ([str(tmp_path / "x.foo")], "unknown output format"),
        ([str(tmp_path / "y.toml"), str(tmp_path / "y.geometry.obj")], "written over"),
    ):
        assert main(["convert", source, *wrong]) == 2
        assert says in capsys.readouterr().err
    assert main(["convert", "room", str(tmp_path / "x.csv")]) == 2
    assert "no results" in capsys.readouterr().err


def test_help_names_what_is_to_be_given(capsys):
    for command in ARGUMENTS:
        assert main([command.__name__, "--help"]) == 0
        usage = capsys.readouterr().out.splitlines()[0]
        assert usage == f"Usage: radiosity {command.__name__} {ARGUMENTS[command]}"
    for name in app:
        if not name.startswith("-"):
            main([name, "--help"])
            assert "ARGS" not in capsys.readouterr().out, name


@pytest.mark.parametrize(
    ("suffix", "name"), [(".obj", "north wall"), (".xml", "north wall"), (".mgf", "north_wall"), (".rad", "north_wall")]
)
def test_line_breaks_in_names_become_what_blanks_do(suffix, name, tmp_path):
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2]], 0.25, 2.0, two_sided=suffix == ".obj", names=["north\n\u2028wall"])
    read, _ = again(scene, tmp_path / f"x{suffix}")
    assert read.names[0].startswith(name)


def test_libraries_have_no_blanks_in_their_names(tmp_path):
    """Many programs read the name of a library up to its first blank."""
    scene = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.25, 2.0, two_sided=True, names=["a wall"])
    read, told = again(scene, tmp_path / "my room.obj")
    assert not told
    assert read.reflectance.tolist() == [[0.25]]
    assert "mtllib my_room.mtl\n" in (tmp_path / "my room.obj").read_text()
    assert read.names == ("a wall",)


@pytest.mark.parametrize("suffix", [".glb", ".obj"])
def test_a_toml_of_the_same_name_leaves_its_source_as_it_is(suffix, tmp_path):
    source = tmp_path / f"room{suffix}"
    scene = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.25, 2.0, two_sided=True, names=["wall"])
    colours = Paint((), np.full(1, -1, np.int32), np.zeros((1, 4, 2), np.float32), np.full((1, 4, 1), 0.5, np.float32), 0.95)
    rd.save_scene(replace(scene, reflectance_paint=colours) if suffix == ".glb" else scene, source)
    before = source.read_bytes()
    assert main(["convert", str(source), str(tmp_path / "room.toml")]) == 0
    assert source.read_bytes() == before
    assert (tmp_path / f"room.geometry{suffix}").exists()


def test_scenes_of_other_bands_are_refused(tmp_path):
    scene = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], [[0.1, 0.2]], [[1, 2]], bands=("a", "b"))
    with pytest.raises(rd.OutputError, match="2 bands"):
        rd.save_scene(scene, tmp_path / "x.toml")


@pytest.mark.parametrize("suffix", [".glb", ".obj", ".ply", ".stl", ".rad", ".mgf", ".hbjson"])
def test_what_lines_pass_does_not_become_a_wall(suffix, tmp_path):
    """A surface that lines pass and that does not shine is left out, one that shines becomes an opaque lamp; both are told."""
    corners = [corner for z in range(3) for corner in ([0, 0, z], [1, 0, z], [0, 1, z])]
    faces = np.arange(9).reshape(3, 3)
    values = {"surface": [0, 1, 2], "names": ["air", "lamp", "wall"], "back": [rd.Back.OPEN, rd.Back.OPEN, rd.Back.RADIATES]}
    scene = rd.Scene.from_arrays(corners, faces, [[0], [0], [0.5]], [[0], [1], [0]], **values)
    read, told = again(scene, tmp_path / f"x{suffix}")
    text = "\n".join(told)
    assert "lines pass on both sides are left out: 'air'" in text
    assert ("lamps that lines pass absorb what comes to them: 'lamp'" in text) == (suffix != ".rad")
    assert read.area.sum() == pytest.approx(1.0)
    with pytest.raises(rd.OutputError, match="nothing would be in it"):
        rd.save_scene(scene.take(np.array([0])), tmp_path / f"y{suffix}")
    read, told = again(scene, tmp_path / "z.toml")
    assert not told
    assert read.back.tolist() == scene.back.tolist()


@pytest.mark.parametrize(("suffix", "says"), [(".glb", " -> surface 0"), (".ply", "loses its name"), (".stl", "loses its name")])
def test_a_name_that_is_lost_is_told(suffix, says, tmp_path):
    name = "" if suffix == ".glb" else "wall"
    scene = rd.Scene.from_arrays([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.25, 0.0, two_sided=True, names=[name])
    read, told = again(scene, tmp_path / f"x{suffix}")
    assert any(says in text for text in told)
    assert read.names == (("surface 0",) if suffix == ".glb" else ("x",))
    kept, told = again(scene, tmp_path / "x.hbjson")
    assert kept.names == (name,)
    assert not told


@pytest.mark.parametrize("suffix", [".stl", ".glb", ".ply"])
@pytest.mark.parametrize("far", [0.0, 1e5])
def test_areas_that_single_precision_changes_are_told(suffix, far, tmp_path):
    """A strip of 1 cm and of 1 m: coordinates of 32 bits lie 8 mm apart at 100 km; a glTF file has an origin for the surface."""
    corners = np.array([[0, 0, 0], [1.0, 0, 0], [0, 0.01, 0]]) + far
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2]], 0.5, 0.0, two_sided=True, names=["strip"])
    read, told = again(scene, tmp_path / f"x{suffix}")
    changed = any("coordinates of 32 bits change areas" in text and "'strip'" in text for text in told)
    assert changed == (suffix == ".stl" and far > 0)
    assert (abs(read.area.sum() / scene.area.sum() - 1) > 1e-3) == changed


def test_backs_of_other_colours_are_told_where_faces_have_one(tmp_path):
    scene = rd.Scene.from_arrays(
        [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], 0.25, 0.0, two_sided=True, back_reflectance=0.75, names=["x"]
    )
    read, told = again(scene, tmp_path / "x.ply")
    assert read.reflectance_paint.color[0, 0] * read.reflectance[0] == pytest.approx(np.full(3, 0.25))
    assert any("backs that reflect otherwise get the reflectance of their fronts: 'x'" in text for text in told)
