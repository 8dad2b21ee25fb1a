"""IES LM-63 files: each feature that changes light is in one small file, whose flux or intensity is known."""

import numpy as np
import pytest
from luminaire_files import GAMMA, LAMBERTIAN, ies

import radiosity as rd
from radiosity.scene.lights.ies import read

FLUX = np.pi * (1 - np.radians(5) ** 2 / 12)  # of LAMBERTIAN, linear between entries of 5 degrees


@pytest.fixture
def photometry(tmp_path):
    def of(text: str, encoding: str = "utf-8"):
        path = tmp_path / "lamp.ies"
        path.write_bytes(text.encode(encoding))
        return read(path)

    return of


def asymmetric(planes) -> np.ndarray:
    """Intensities of planes C, with no symmetry but C and -C: 2 + cos C, times that of a diffuse disc."""
    return (2 + np.cos(np.radians(planes)))[:, None] * np.array(LAMBERTIAN)


def at(web, plane: float, gamma: float) -> float:
    """The bilinear intensity in a direction, degrees."""
    rows = [np.interp(gamma, web.gamma, row, left=0, right=0) for row in web.intensity]
    return float(np.interp(plane, web.planes, rows)) if len(rows) > 1 else float(rows[0])


@pytest.mark.parametrize(
    "first", ["", "IESNA91", "IESNA:LM-63-1995", "IESNA:LM-63-2002", "IES:LM-63-2019"], ids=["86", "91", "95", "02", "19"]
)
@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"], ids=["lf", "crlf", "cr"])
def test_all_revisions_and_line_ends(photometry, first, ends):
    found = photometry(ies(first=first, ends=ends))
    assert found.flux == pytest.approx(FLUX, rel=1e-5)
    assert found.web.intensity[0, 0] == 1
    assert (found.name, found.manufacturer, found.watts, found.notes) == ("Globe", "Ours", 10, ())


def test_words_may_be_parted_by_commas_and_lines(photometry):
    text = ies(between=", ")
    head, numbers = text.split("TILT=NONE\n")
    assert photometry(text).flux == pytest.approx(FLUX, rel=1e-5)
    assert photometry(head + "TILT=NONE\n" + numbers.replace(", ", "\n")).flux == pytest.approx(FLUX, rel=1e-5)


def test_names_in_latin_1(photometry):
    assert photometry(ies(keywords=["[LUMINAIRE] Büro"]), "latin-1").name == "Büro"


@pytest.mark.parametrize(("first", "factor"), [("", 2 * 0.9 * 1.1), ("IESNA91", 2 * 0.9 * 1.1), ("IESNA:LM-63-1995", 1.8)])
def test_factors_are_applied_once(photometry, first, factor):
    """The multiplier, the ballast factor, and the ballast-lamp factor of files up to 1991; the lamps' number never."""
    found = photometry(ies(first=first, lamps=4, lumens=900, multiplier=2, ballast=0.9, second=1.1))
    assert found.flux == pytest.approx(FLUX * factor, rel=1e-5)
    assert any("is no factor" in note for note in found.notes) == ("1995" in first)


def test_the_kind_of_a_file_of_2019_is_no_factor(photometry):
    """1.10011 says who measured it."""
    found = photometry(ies(first="IES:LM-63-2019", second=1.10011))
    assert found.flux == pytest.approx(FLUX, rel=1e-5)
    assert found.notes == ()


def test_absolute_photometry(photometry):
    found = photometry(ies(lamps=3, lumens=-1))
    assert found.flux == pytest.approx(FLUX, rel=1e-5)
    assert np.isnan(found.stated)
    assert found.notes == ()


def test_a_name_never_dims(photometry):
    """Radiance's table of lamps has 0.85 for this one."""
    named = ies(keywords=["[LAMP] LED warm white", "[LAMPCAT] LED warm white"])
    assert photometry(named).flux == pytest.approx(FLUX, rel=1e-5)


def test_more_light_than_the_lamps_send_is_told_with_both_numbers(photometry):
    (note,) = photometry(ies(lamps=2, lumens=1.0)).notes
    assert "3.1" in note
    assert "(2 lm)" in note


@pytest.mark.parametrize(
    ("planes", "mirror"),
    [((0, 30, 60, 90), 90), ((0, 45, 90, 135, 180), 180), ((90, 120, 150, 180, 230, 270), 270), ((0, 90, 180, 300, 360), 360)],
    ids=["quarter", "half", "90-270", "whole"],
)
def test_planes_are_unfolded(photometry, planes, mirror):
    rows = np.arange(1.0, len(planes) + 1)
    if mirror == 360:
        rows[-1] = rows[0]
    web = photometry(ies(rows[:, None] * np.array(LAMBERTIAN), horizontal=planes)).web
    assert (web.planes[0], web.planes[-1]) == (0, 360)
    assert (np.diff(web.planes) > 0).all()
    for plane in (0.0, 10, 77, 100, 179, 181, 250, 300, 355):
        if mirror == 90:
            same = min(plane % 180, 180 - plane % 180)
        elif mirror == 180:
            same = min(plane, 360 - plane)
        elif mirror == 270:
            same = (180 - plane) % 360 if not 90 <= plane <= 270 else plane
        else:
            same = plane
        assert at(web, plane, 0.0) == pytest.approx(np.interp(same, planes, rows))


def test_planes_that_stop_before_360_are_closed_and_told(photometry):
    planes = np.arange(0, 360, 30)
    found = photometry(ies(asymmetric(planes), horizontal=planes))
    assert found.web.planes[-1] == 360
    assert at(found.web, 345, 0) == pytest.approx((3 + 2 + np.cos(np.radians(330))) / 2)
    assert "330" in found.notes[0]


def test_tilt_of_the_lamp(photometry, tmp_path):
    """A lamp of 1.0, 0.9 and 0.8 at 0, 45 and 90 degrees from straight down: linear between them, also in a file of its own."""
    assert photometry(ies(tilt="Tilt = none")).tilt is None
    assert photometry(ies(tilt="TILT=INCLUDE\n3\n2\n0 90\n1 1")).tilt is None
    found = photometry(ies(tilt="TILT=INCLUDE\n1\n3\n0 45 90\n1.0 0.9 0.8"))
    assert (found.notes, found.flux) == ((), pytest.approx(FLUX, rel=1e-5))
    (tmp_path / "bulb.tlt").write_text("1\n3\n0 45 90\n1.0 0.9 0.8\n")
    (tmp_path / "named.ies").write_text(ies(tilt="TILT=bulb.tlt"))

    def power(way, lamp=found, **more):
        return rd.read_luminaire(lamp, position=(0, 0, 0), direction=way, **more).power[0] / FLUX

    for lamp in (found, rd.load_photometry(tmp_path / "named.ies")):
        factors = [power(way, lamp) for way in ((0, 0, -1), (1, 0, -1), (0, 1, 0), (0, np.tan(np.radians(30)), -1))]
        assert factors == pytest.approx([1, 0.9, 0.8, 1 - 0.2 / 3], rel=1e-5)
    assert power((0, -1, 0), up="y") == pytest.approx(1, rel=1e-5)
    assert power((0, 1, 0), lumens=500) == pytest.approx(500 / FLUX)
    with pytest.warns(rd.RadiosityWarning, match=r"tilted by 135.0 degrees, and the factors of its file \(TILT\) are for 0 to"):
        assert power((1, 0, 1)) == pytest.approx(0.8, rel=1e-5)
    assert "bulb.tlt" in photometry(ies(tilt="TILT=../bulb.tlt")).notes[0]
    damaged = {"0 90\n1 -1": "a factor of TILT is -1", "90 0\n1 1": "do not ascend", "0 90\n1 0": "gives no light"}
    for tilt, words in damaged.items():
        with pytest.raises(rd.SceneError, match=words):
            power((1, 0, 0), photometry(ies(tilt=f"TILT=INCLUDE\n1\n2\n{tilt}")))


@pytest.mark.parametrize(
    ("size", "unit", "wanted", "disc"),
    [
        ((0.3, 1.2, 0.05), 2, (1.2, 0.3, 0.05), False),
        ((1, 4, 0), 1, (1.2192, 0.3048, 0), False),
        ((-0.2, -0.2, 0), 2, (0.2, 0.2, 0), True),
        ((-0.2, 0, 0), 2, (0.2, 0.2, 0), True),
        ((-0.2, -0.6, 0.1), 2, (0.6, 0.2, 0.1), True),
        ((-0.2, -0.2, -0.2), 2, (0.2, 0.2, 0.2), True),
        ((0, 0, 0), 1, (0, 0, 0), False),
    ],
)
def test_luminous_sizes(photometry, size, unit, wanted, disc):
    """Width is across, length along the plane of 0; negative numbers are diameters."""
    found = photometry(ies(size=size, unit=unit))
    assert found.size == pytest.approx(np.array(wanted))
    assert found.disc == disc


def beam(h, v, middle=(0.0, 0.0)) -> np.ndarray:
    """A round beam of 10 degrees about a direction given by H and V."""
    return np.exp(-(((h[:, None] - middle[0]) / 10) ** 2) - ((v[None, :] - middle[1]) / 10) ** 2)


@pytest.mark.parametrize(
    ("kind", "middle", "wanted"),
    [
        (2, (0, 0), (0, 0, 1)),
        (2, (30, 0), (0, -0.5, np.cos(np.pi / 6))),
        (2, (0, 30), (0.5, 0, np.cos(np.pi / 6))),
        (3, (0, 0), (0, 0, 1)),
        (3, (30, 0), (0, -0.5, np.cos(np.pi / 6))),
        (3, (0, 30), (0.5, 0, np.cos(np.pi / 6))),
    ],
)
def test_types_a_and_b_become_type_c(photometry, kind, middle, wanted):
    """The beam's mean direction (to C = 0, C = 90, gamma = 0) and its flux, by numeric integration in the file's own angles."""
    h = v = np.arange(-90.0, 91, 3)
    found = photometry(ies(beam(h, v, middle), v, h, kind=kind))
    web = found.web
    c, g = np.radians(web.planes[:-1, None]), np.radians(web.gamma[None, :])
    weight = web.intensity[:-1] * np.sin(g)
    mean = np.array([(weight * x).sum() for x in (np.cos(c) * np.sin(g), np.sin(c) * np.sin(g), np.cos(g) + 0 * c)])
    assert mean / np.linalg.norm(mean) == pytest.approx(np.array(wanted), abs=0.01)
    cosine = np.cos(np.radians(h))[:, None] if kind == 2 else np.cos(np.radians(v))[None, :]
    assert found.flux == pytest.approx((beam(h, v, middle) * cosine).sum() * np.radians(3) ** 2, rel=0.01)
    assert not found.notes


def test_type_b_of_one_side_is_the_same_on_the_other(photometry):
    v, h = np.arange(-90.0, 91, 5), np.arange(0.0, 91, 5)
    whole = np.arange(-90.0, 91, 5)
    one = photometry(ies(beam(h, v), v, h, kind=2))
    both = photometry(ies(beam(whole, v), v, whole, kind=2))
    assert np.array_equal(one.web.intensity, both.web.intensity)


FAULTS = {
    "no TILT": (lambda text: text.replace("TILT", "TILTED"), "no line TILT="),
    "word": (lambda text: text.replace("\n0\n", "\nzero\n"), "line 9: the horizontal angles: there is 'zero', which is no"),
    "cut": (lambda text: text[:-40], "is it cut off"),
    "type": (lambda text: text.replace(" 1 2 0 0 0", " 4 2 0 0 0"), "photometric type"),
    "unit": (lambda text: text.replace(" 1 2 0 0 0", " 1 3 0 0 0"), "unit"),
    "multiplier": (lambda text: text.replace("1 -1 1 37", "1 -1 0 37"), "line 6: the multiplier is 0"),
    "count": (lambda text: text.replace("1 -1 1 37", "1 -1 1 3.5"), "line 6: the number of vertical angles is 3.5"),
    "negative": (lambda text: text.replace("\n1 0.996", "\n-1 0.996"), "is -1 cd"),
    "not finite": (lambda text: text.replace("\n1 0.996", "\nnan 0.996"), "which is no number"),
    "order": (lambda text: text.replace("0 5 10", "0 10 5"), "do not ascend: 10 is followed by 5"),
    "dark": (lambda text: text[: text.rindex("\n1 0.996")] + "\n" + "0 " * 37, "sends no light"),
    "zeros": (lambda text: "\0" + text, "is no text"),
    "huge": (lambda text: text.replace("37 1 1 2", "7999 7999 1 2"), "is it cut off"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_one_error_with_file_and_value(photometry, name):
    edit, says = FAULTS[name]
    assert edit(ies()) != ies()
    with pytest.raises(rd.SceneError, match=r"lamp\.ies") as error:
        photometry(edit(ies()))
    assert says in str(error.value)


@pytest.mark.parametrize(("multiplier", "says"), [(1e306, "not believed"), (1e-30, "sends no light")])
def test_light_that_no_lamp_sends_is_refused(tmp_path, multiplier, says):
    (tmp_path / "lamp.ies").write_text(ies(np.array(LAMBERTIAN) * 1e4, multiplier=multiplier))
    with pytest.raises(rd.SceneError, match=says):
        rd.load_photometry(tmp_path / "lamp.ies")


def test_small_negative_values_and_numbers_that_follow_are_told(photometry):
    table = np.array(LAMBERTIAN)
    table[-1] = -0.001
    found = photometry(ies(table) + "7 8\n")
    assert found.web.intensity.min() == 0
    assert len(found.notes) == 2
    assert "-0.001 cd" in " ".join(found.notes)


def test_truncated_files_never_end_in_another_error(photometry):
    text = ies(asymmetric((0, 90, 180)), GAMMA, (0, 90, 180), tilt="TILT=INCLUDE\n1\n2\n0 90\n1 0.5")
    for length in range(0, len(text) - 4, 7):
        with pytest.raises(rd.SceneError):
            photometry(text[:length])
