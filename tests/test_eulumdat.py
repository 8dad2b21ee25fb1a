"""EULUMDAT files: each feature that changes light is in one small file, whose flux or intensity is known."""

import numpy as np
import pytest
from luminaire_files import LAMBERTIAN, ldt

import radiosity as rd
from radiosity.scene.lights.eulumdat import read

PLANES = tuple(range(0, 360, 15))
FLUX = np.pi * (1 - np.radians(5) ** 2 / 12)  # of LAMBERTIAN, linear between entries of 5 degrees


@pytest.fixture
def photometry(tmp_path):
    def of(text: str, encoding: str = "utf-8", **options):
        path = tmp_path / "lamp.ldt"
        path.write_bytes(text.encode(encoding))
        return read(path, **options)

    return of


def rows_of(planes) -> np.ndarray:
    return (2 + np.cos(np.radians(planes)) + 0.5 * np.sin(np.radians(planes)))[:, None] * np.array(LAMBERTIAN)


@pytest.mark.parametrize("ends", ["\r\n", "\n"], ids=["crlf", "lf"])
@pytest.mark.parametrize("encoding", ["utf-8", "latin-1"])
def test_a_file_and_its_flux(photometry, ends, encoding):
    found = photometry(ldt(LAMBERTIAN, PLANES, symmetry=1, ends=ends), encoding)
    assert found.flux == pytest.approx(FLUX, rel=1e-5)
    assert (found.name, found.manufacturer, found.watts, found.notes) == ("Leuchte für Büros", "Ours", 12.5, ())


def test_intensities_are_of_1000_lm_of_all_lamps_of_a_set(photometry):
    """Twice two lamps of 1500 lm together, and not each."""
    found = photometry(ldt(LAMBERTIAN, PLANES, symmetry=1, sets=((2, 3000.0),)))
    assert found.flux == pytest.approx(3 * FLUX, rel=1e-5)


def test_the_first_lamp_set_counts_unless_asked(photometry):
    text = ldt(LAMBERTIAN, PLANES, symmetry=1, sets=((1, 1000.0), (1, 2500.0)))
    found = photometry(text)
    assert found.flux == pytest.approx(FLUX, rel=1e-5)
    assert "1000, 2500 lm; the first" in found.notes[0]
    asked = photometry(text, lamp_set=2)
    assert asked.flux == pytest.approx(2.5 * FLUX, rel=1e-5)
    assert not asked.notes
    with pytest.raises(rd.SceneError, match="no set 3"):
        photometry(text, lamp_set=3)


def test_the_conversion_factor_is_applied_once(photometry):
    assert photometry(ldt(LAMBERTIAN, PLANES, symmetry=1, conversion=1.5)).flux == pytest.approx(1.5 * FLUX, rel=1e-5)


def test_a_negative_number_of_lamps_is_absolute_photometry(photometry):
    scale = 1000 / FLUX
    found = photometry(ldt(np.array(LAMBERTIAN) * scale, PLANES, symmetry=1, sets=((-1, 840.0),)))
    assert found.stated == 840
    assert found.flux == pytest.approx(840, rel=1e-5)
    assert not found.notes


def test_decimal_commas(photometry):
    text = ldt(LAMBERTIAN, PLANES, symmetry=1, conversion=1.5, comma=True)
    assert "\r\n1,5\r\n" in text
    assert photometry(text).flux == pytest.approx(1.5 * FLUX, rel=1e-5)


@pytest.mark.parametrize("symmetry", [0, 1, 2, 3, 4])
def test_symmetries_are_unfolded(photometry, symmetry):
    """Each plane of the whole circle has the intensity of the plane that it mirrors."""
    given = {
        0: np.array(PLANES),
        1: np.zeros(1),
        2: np.arange(0, 181, 15),
        3: np.arange(-90, 91, 15),
        4: np.arange(0, 91, 15),
    }[symmetry]
    web = photometry(ldt(rows_of(given), PLANES, symmetry=symmetry)).web
    for plane in PLANES:
        mirrored = {
            0: plane,
            1: 0,
            2: min(plane, 360 - plane),
            3: plane if plane <= 90 else (plane - 360 if plane >= 270 else 180 - plane),
            4: min(plane % 180, 180 - plane % 180),
        }[symmetry]
        row = web.intensity[np.flatnonzero(web.planes == plane)[0]] if len(web.planes) > 1 else web.intensity[0]
        assert row == pytest.approx(rows_of(np.array([mirrored]))[0], rel=1e-6)
    assert len(web.planes) == 1 or (web.planes[-1] == 360 and np.array_equal(web.intensity[0], web.intensity[-1]))


def test_the_stated_flux_is_held_against_the_integral(photometry):
    good = np.array(LAMBERTIAN) * 1000 / FLUX * 0.8
    assert not photometry(ldt(good, PLANES, symmetry=1, efficiency=80, downward=100)).notes
    (note,) = photometry(ldt(good, PLANES, symmetry=1, efficiency=70, downward=100)).notes
    assert "700 lm" in note
    assert " 800 lm" in note
    (note,) = photometry(ldt(good, PLANES, symmetry=1, efficiency=80, downward=60)).notes
    assert "60 %" in note
    assert "100 %" in note


def test_the_luminous_area(photometry):
    """In millimetres; its length is along C = 90, and without a width it is round."""
    found = photometry(ldt(LAMBERTIAN, PLANES, symmetry=1, size=(1200, 300, 10, 20, 30, 5)))
    assert found.size == pytest.approx(np.array([0.3, 1.2, 0.03]))
    assert not found.disc
    found = photometry(ldt(LAMBERTIAN, PLANES, symmetry=1, size=(200, 0, 0, 0, 0, 0)))
    assert found.size == pytest.approx(np.array([0.2, 0.2, 0]))
    assert found.disc


def test_a_tilt_at_measurement_is_told(photometry):
    assert "15 degrees" in photometry(ldt(LAMBERTIAN, PLANES, symmetry=1, tilt=15)).notes[0]


FAULTS = {
    "symmetry": ({3: "5"}, "line 3: the symmetry (Isym) is 5"),
    "word": ({24: "one"}, "line 24: the conversion factor: there is 'one'"),
    "lamps": ({29: "0"}, "line 29: the flux of all lamps of set 1 is 0"),
    "planes": ({4: "9000"}, "line 4: the number of planes C (Mc) is 9000"),
    "sets": ({26: "-1"}, "line 26: the number of lamp sets is -1"),
    "negative": ({104: "-5"}, "is -5 cd"),
    "order": ({45: "1"}, "do not ascend: 15 is followed by 1"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_one_error_with_line_and_value(photometry, name):
    changed, says = FAULTS[name]
    lines = ldt(LAMBERTIAN, PLANES, symmetry=1).split("\r\n")
    for number, text in changed.items():
        lines[number - 1] = text
    with pytest.raises(rd.SceneError, match=r"lamp\.ldt") as error:
        photometry("\r\n".join(lines))
    assert says in str(error.value)


def test_truncated_files_never_end_in_another_error(photometry):
    text = ldt(LAMBERTIAN, PLANES, symmetry=1)
    for length in range(0, len(text) - 30, 11):
        with pytest.raises(rd.SceneError):
            photometry(text[:length])
