"""Clear glass: what goes through depends on the angle, by Fresnel's formulas, and what its solid part takes stays reciprocal."""

from dataclasses import replace

import numpy as np
import pytest
from test_diffusers import means, two_boxes
from test_light_referees import LUX, room, through

import radiosity as rd
from radiosity.image.through import through_at
from radiosity.scene.clear_glass import mean_share, of_mean, of_normal, share_at
from radiosity.scene.shapes import quad

INDEX, CLEAR = 1.52, 0.96
MEAN = float(mean_share(CLEAR, INDEX))
WINDOW = quad((1.5, 0, 1), (0, 0, 1), (1, 0, 0))


def fresnel(cosine) -> np.ndarray:
    """The share by Hecht's Optics: rays that are reflected to and fro within the pane, summed one by one."""
    inner = np.sqrt(1 - (1 - np.asarray(cosine) ** 2) / INDEX**2)
    kept, total = CLEAR ** (1 / inner), 0.0
    for side in ((cosine - INDEX * inner) / (cosine + INDEX * inner), (INDEX * cosine - inner) / (INDEX * cosine + inner)):
        reflected = side**2
        total = total + sum((1 - reflected) ** 2 * kept * (reflected * kept) ** (2 * n) for n in range(60)) / 2
    return total


def glazed(faces, is_pane, index=INDEX, **more) -> rd.Scene:
    n = len(faces)
    return rd.Scene.from_arrays(
        np.concatenate(faces),
        np.arange(4 * n).reshape(n, 4),
        0.0,
        more.pop("emission", 0.0),
        surface=np.asarray(is_pane, int),
        names=["walls", "pane"],
        two_sided=is_pane,
        transmittance=MEAN * np.asarray(is_pane),
        refractive_index=index * np.asarray(is_pane),
        photometric=True,
        **more,
    )


def test_the_formulas():
    cosine = (np.arange(4000) + 0.5) / 4000
    np.testing.assert_allclose(share_at(cosine, CLEAR, INDEX), fresnel(cosine), rtol=1e-9, atol=1e-6)
    assert pytest.approx((fresnel(cosine) * 2 * cosine).mean(), rel=1e-5) == MEAN
    assert of_mean(MEAN, INDEX) == pytest.approx(CLEAR, rel=1e-9)
    assert of_normal(float(fresnel(1.0)), INDEX) == pytest.approx(CLEAR, rel=1e-9)


def test_the_sun_through_a_pane():
    """At 15 degrees above the pane 0.58 goes through, 0.81 of diffuse light, 0.88 at right angles; the pane stops the rest."""
    floor, pane = quad((-1, -1, 0), (2, 0, 0), (0, 2, 0)), quad((-9, -9, 1), (18, 0, 0), (0, 18, 0))
    for altitude, method in ((15, "gather"), (60, "gather"), (30, "random-walk")):
        scene = glazed([floor, pane], [False, True]).with_lights(suns=[rd.sun(1000, altitude=altitude, azimuth=180)])
        solution = rd.solve(rd.subdivide(scene, cells=1), method, rays=400_000, replicates=8)
        cosine = np.sin(np.radians(altitude))
        for patch, wanted in ((0, fresnel(cosine)), (1, (1 - fresnel(cosine)) / (1 - MEAN))):
            wanted, error = 1000 * cosine * wanted, solution.irradiance_standard_error[patch, 0]
            assert abs(solution.irradiance[patch, 0] - wanted) < 5 * error + 1e-3 * wanted
            assert error < 0.06 * wanted


def test_a_sensor_deep_in_a_room_sees_the_sky_through_glass():
    """Light that comes nearly straight: one transmittance for all angles would be 9 % too small."""
    walls = room((4, 5, 3), ((1.5, 0, 1), (2.5, 0, 2)))[3]
    scene = glazed([*walls, WINDOW], [False] * len(walls) + [True]).with_lights(sky=rd.uniform_sky(LUX), openings=[WINDOW])
    points, normal = np.array([[2.0, 4.0, 0.9], [1.2, 0.6, 0.9]]), np.array([0.0, -1.0, 0.0])
    solution = rd.solve(rd.subdivide(scene, cells=1), "gather", rays=5_000, replicates=8)
    found = rd.measure(solution, rd.Sensors.of(points, normal), rays=200_000)
    wanted = through(WINDOW, points, normal, lambda ways: LUX / np.pi * fresnel(np.abs(ways[..., 1])))
    plain = through(WINDOW, points, normal, lambda ways: np.full(ways.shape[:-1], LUX / np.pi * MEAN))
    assert (np.abs(found.illuminance[:, 0] - wanted) < 4 * found.standard_error[:, 0]).all()
    assert abs(wanted[0] - plain[0]) > 8 * found.standard_error[0, 0]
    assert plain[0] < 0.93 * wanted[0]


@pytest.mark.parametrize("method", ["random-walk", "particle-tracing", "gather", "stochastic-jacobi-incremental"])
def test_all_methods_solve_a_box_behind_glass(method):
    """Black walls of exitance 3 before the glass, and of 1 behind it: each side of it sees one radiosity from everywhere."""
    scene = two_boxes((3.0, 1.0), (0.0, 0.0), rho=0.0, tau=0.0, clear=MEAN)
    scene = replace(scene, refractive_index=INDEX * scene.panes)
    patches = rd.subdivide(scene, cells=1)
    solution = rd.solve(patches, method, rays=100_000, replicates=8)
    lines = rd.trace_lines(patches, rays=100_000).solve()  # each line counts at both its ends
    for found in (solution, lines):
        error = means(found, found.irradiance_standard_error)[:, 0]
        assert (np.abs(means(found, found.irradiance)[[2, 3], 0] - [3, 1]) < 5 * error[2:]).all()
    walls = means(solution, solution.irradiance)[:2, 0] - means(lines, lines.irradiance)[:2, 0]
    assert (np.abs(walls) < 5 * error[:2] + 5 * means(solution, solution.irradiance_standard_error)[:2, 0]).all()


def test_what_glass_takes_and_sends_is_reciprocal():
    """A_i F_ij = A_j F_ji between its solid part and each wall, along lines that begin at either. Flat ones meet more of it."""
    scene = two_boxes((3.0, 1.0), (0.0, 0.0), rho=0.0, tau=0.0, clear=MEAN)
    patches = rd.subdivide(replace(scene, refractive_index=INDEX * scene.panes), cells=1)
    lines = rd.trace_lines(patches, rays=300_000, replicates=8).one_way
    factors = lines.pairs.between(np.arange(len(patches)))[:, :, : len(patches)]
    exchange = factors * patches.solid.area[:, None]
    pane, walls = np.flatnonzero(patches.surface == 2)[0], np.arange(5)
    there, back = exchange[:, pane, walls], exchange[:, walls, pane]
    error = np.sqrt((there.var(axis=0, ddof=1) + back.var(axis=0, ddof=1)) / 8)
    assert (np.abs(there.mean(axis=0) - back.mean(axis=0)) < 5 * error).all()
    assert (error < 0.06 * back.mean(axis=0)).all()
    # between opposite squares of a cube 0.1998 of cosine distributed lines: glass lets most of these through
    assert there.mean(axis=0)[4] + 5 * error[4] < 0.9 * 0.1998 * patches.solid.area[pane]


def test_hashes_files_and_choices_of_faces(tmp_path):
    scene = glazed([WINDOW, np.add(WINDOW, [0, 1, 0])], [False, True], emission=[1.0, 0.0])
    plain = replace(scene, refractive_index=None)
    assert len({scene.geometry_hash, plain.geometry_hash}) == len({scene.hash, plain.hash}) == 2
    assert scene.take(np.array([1])).refractive_index.tolist() == [INDEX]
    assert scene.take(np.array([0])).refractive_index is None
    rd.solve(rd.subdivide(scene, cells=1), rays=1_000).save(tmp_path / "a.npz")
    assert rd.load_solution(tmp_path / "a.npz").patches.scene.refractive_index.tolist() == [0, INDEX]


def test_lines_of_sight_go_through_by_their_angle():
    scene = glazed([WINDOW], [True])
    rays = np.array([[0, 1.0, 0], [0, 0.5, np.sqrt(0.75)], [0, -0.5, np.sqrt(0.75)]])
    np.testing.assert_allclose(through_at(scene, np.zeros(3, int), rays), fresnel(np.array([1, 0.5, 0.5])), rtol=1e-6)


def test_what_is_no_glass_is_refused_by_name():
    plain = {"vertices": WINDOW, "faces": [[0, 1, 2, 3]], "emission": 0.0, "reflectance": 0.0, "names": ["pane"]}
    plain |= {"transmittance": 0.8, "refractive_index": 1.5, "two_sided": True}
    for more, words in (
        ({"transmittance": 0.9}, ["pane", "0.9", "at most 0.8"]),
        ({"transmittance": 0.0}, ["pane", "must let some"]),
        ({"refractive_index": 0.5}, ["pane", "0.5", "above 1"]),
        ({"reflectance": 0.1}, ["pane", "reflects, emits and diffuses nothing"]),
        ({"diffuse_transmittance": 0.1}, ["pane", "reflects, emits and diffuses nothing"]),
        ({"refractive_index": [1.5, 1.5]}, ["shape"]),
    ):
        with pytest.raises(rd.SceneError) as refused:
            rd.Scene.from_arrays(**plain | more)
        assert all(word in str(refused.value) for word in words), str(refused.value)
    lit = glazed([WINDOW, np.add(WINDOW, [0, 1, 0])], [False, True], emission=[1.0, 0.0])
    with pytest.raises(rd.MethodError, match=r"pane.*refractive_index"):
        rd.solve(lit, "full-matrix")


def test_files(tmp_path):
    (tmp_path / "a.rad").write_text("void glass m 0 0 3 .96 .96 .96\nm polygon a 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n")
    with pytest.warns(rd.RadiosityWarning):
        scene = rd.load_scene(tmp_path / "a.rad")
    assert scene.refractive_index.tolist() == [1.52]
    assert scene.transmittance[0] == pytest.approx(MEAN)
    (tmp_path / "a.obj").write_text("o pane\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n")

    def load(settings):
        (tmp_path / "a.toml").write_text(f'geometry = "a.obj"\n[[surface]]\nname = "*"\nreflectance = 0\n{settings}\n')
        return rd.load_scene(tmp_path / "a.toml")

    scene = load(f"transmittance = {float(fresnel(1.0)):.17g}\nrefractive_index = 1.52")
    assert scene.transmittance[0] == pytest.approx(MEAN)
    assert load("transmittance = 0.8").refractive_index is None
    for settings, message in (
        ("refractive_index = 1.5", "give its transmittance"),
        ("transmittance = 0.95\nrefractive_index = 1.5", r"'pane' has a transmittance of 0\.95.*at most 0\.92"),
        ("transmittance = 0.8\nrefractive_index = 0.9", "refractive_index"),
    ):
        with pytest.raises(rd.SceneError, match=message):
            load(settings)
