"""The memory estimate of a year of daylight: what was measured of fresh processes lies below it, and not far below."""

import pytest

import radiosity as rd
from radiosity.sensors.annual.memory import YearSizes
from radiosity.sensors.receivers import PLANES, planes_of

MIB = 2**20
PEAKS = [  # patches, sensors, sky patches, replicates, lines of a kind and sensor; MiB (docs/annual-daylight.md)
    (1972, 200, 146, 2, 722, 58),
    (1972, 200, 578, 8, 361, 304),
    (90, 50, 146, 2, 68_966, 145),
    (90, 2000, 146, 2, 6180, 383),
    (19_864, 50, 146, 2, 997, 377),
]


@pytest.mark.parametrize(("patches", "sensors", "sky", "replicates", "each", "peak"), PEAKS)
def test_the_estimate_holds_what_was_measured(patches, sensors, sky, replicates, each, peak):
    together = min(2**23 // max(patches, sensors), 512)
    sizes = YearSizes(sensors, sensors, patches, 10, sky, replicates, each, (0, together))
    assert peak * MIB < sizes.whole() < 1.8 * peak * MIB


def test_the_estimate_grows_with_what_it_follows_from():
    def bytes_of(**given):
        sizes = {"sensors": 50, "planes": 50, "patches": 2000, "faces": 10, "sky": 146, "replicates": 2}
        return YearSizes(**sizes | given).whole()

    plain = bytes_of()
    assert bytes_of(sky=578) > plain
    assert bytes_of(faces=10**6) - plain > 500e6
    assert bytes_of(planes=50 * PLANES) > plain
    assert bytes_of(replicates=8) > 1.5 * plain
    assert bytes_of(hours=(8760, 512)) - plain > 50 * 8760 * 3
    one = YearSizes(50, 50, 2000, 10, 146, 1)
    assert one.on_worker(10**6) < bytes_of(replicates=1) + 50 * 10**6


def test_planes_are_those_of_cylinders():
    points = rd.Sensors.of([[0, 0, 1], [1, 0, 1]])
    assert planes_of(points) == 2


@pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning")  # of the scene's own light
def test_a_year_that_does_not_fit_is_refused_before_it_begins(tmp_path):
    from test_annual import POINTS, epw, office

    year = epw(tmp_path / "made.epw", {(6, 21, 12): (500, 120)})
    with pytest.raises(rd.MethodError, match=r"daylight coefficients of \d sensors .* would take about .*20 MiB are allowed"):
        rd.annual(rd.subdivide(office(), cells=1), year, rd.Sensors.of(POINTS), rays=2000, replicates=2, memory="20M")
