"""The daylight of a year on workers of Dask has the bits of one machine, however its lines are cut."""

import numpy as np
import pytest
from test_annual import POINTS, epw, office

import radiosity as rd
from radiosity.device.backend import choose
from radiosity.problem.model import Problem
from radiosity.sampling.streams import Seed
from radiosity.scene.lights.axes import sky_axes
from radiosity.scene.lights.sky_patches import SkyPatches
from radiosity.sensors.annual import coefficients
from radiosity.sensors.annual.annual import _prepared
from radiosity.sensors.annual.coefficients import Setup
from radiosity.sensors.annual.elsewhere import SkyUnit, SunUnit
from radiosity.tracing.geometry import Geometry

pytest.importorskip("distributed", reason="distributed is not installed")
from radiosity.cluster import room, years

LIGHT = {(month, 21, hour): (400 + 10 * hour, 100 + 7 * month) for month in (3, 6, 9, 12) for hour in (10, 11, 13, 15)}
pytestmark = [
    pytest.mark.filterwarnings("ignore::radiosity.errors.RadiosityWarning"),  # of few lines
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


@pytest.fixture(scope="module")
def year(tmp_path_factory):
    return epw(tmp_path_factory.mktemp("weather") / "made.epw", LIGHT)


def test_a_year_is_that_of_one_machine(client, year, monkeypatch):
    """Two stages, and hours of sun; units are cut as finely as there is work."""
    monkeypatch.setattr(years, "AT_A_TIME", 8)
    monkeypatch.setattr(years.DaskYearLines, "fewest", lambda *_: 1)
    units, traced = [], years.YearJob.traced
    monkeypatch.setattr(years.YearJob, "traced", lambda job, unit: units.append(unit) or traced(job, unit))
    patches, sensors = rd.subdivide(office(), cells=2), rd.Sensors.of(POINTS)
    options = {"error": 0.15, "replicates": 2, "seed": 5, "hourly": True}
    alone, found = (rd.annual(patches, year, sensors, **options, **more) for more in ({}, {"cluster": client}))
    assert alone.coefficients.straight.any()
    assert {type(unit).__name__ for unit in units} == {"SkyUnit", "SunUnit"}
    assert len(units) >= 16
    for name in ("straight", "reflected"):
        assert getattr(found.coefficients, name).tobytes() == getattr(alone.coefficients, name).tobytes(), name
    assert found.hourly.tobytes() == alone.hourly.tobytes()
    assert all(found.values[name].tobytes() == alone.values[name].tobytes() for name in alone.values)
    assert (found.rays, found.status) == (alone.rays, alone.status)


def test_a_worker_with_too_little_memory_for_a_year_is_told(client, year, monkeypatch):
    """Each replicate is checked before its lines begin; a worker with enough goes on."""
    monkeypatch.setattr(years, "FEWEST", 1)
    patches, sensors = rd.subdivide(office(), cells=1), rd.Sensors.of(POINTS)
    monkeypatch.setattr(room, "left", lambda there: 2**20)
    message = r"worker inproc://\S+ has too little memory: the daylight of a year at \d+ sensors and on .* patches.* 1 MiB there"
    with pytest.raises(rd.MethodError, match=message):
        rd.annual(patches, year, sensors, rays=2_000, replicates=2, cluster=client)


def test_parts_of_units_are_the_units(monkeypatch):
    """Lines of each kind, and suns that are met by several rays each, as where panes let some through."""
    axes, sensors = sky_axes(), rd.Sensors.of(POINTS)
    patches = _prepared(rd.subdivide(office(), cells=2), axes)
    geometry, problem = Geometry(patches.solid, choose("auto")), Problem.of(patches)
    geometry.prepare()
    run = Setup(sensors, Seed(2), SkyPatches.of(145), axes).replicate(geometry, problem, 1)
    for kind in (True, False):
        unit = SkyUnit(1, kind, ((3, 40), (5, 21)), 53)
        whole, parts = unit.traced(run), [part.traced(run) for part in unit.cut(3)]
        for number in (0, 1):
            assert whole.tables[number].any()
            assert np.array_equal(whole.tables[number], sum(part.tables[number] for part in parts))
        assert (whole.seen != sum(part.seen for part in parts[1:]) + parts[0].seen).nnz == 0
    sunlight = run.sunlight(patches=False)
    monkeypatch.setattr(run, "sunlight", lambda **_: coefficients.Sunlight(sunlight.lines, sunlight.places, 3))
    towards = np.array([[0.1 * x, -0.8, 0.4] for x in range(-3, 4)])
    towards /= np.linalg.norm(towards, axis=1, keepdims=True)
    unit = SunUnit(1, False, towards, 11, 0, 7, 63)
    whole = unit.traced(run)
    assert whole.any()
    assert np.array_equal(whole, np.concatenate([part.traced(run) for part in unit.cut(3)]))
