"""Runs to an error where no light reaches any patch: they end, and say why."""

import numpy as np
import pytest
from light_samples import lit

import radiosity as rd
from radiosity.run import goal
from radiosity.scene.shapes import box


@pytest.mark.parametrize("method", ["gather", "random-walk"])
def test_a_closed_room_under_a_sky(method, monkeypatch):
    """It went on until the counters were full, for hours."""
    monkeypatch.setattr(goal, "DARK", 1e5)
    scene = lit(("walls", 0.5, 0.0, box((0, 0, 0), (4, 4, 3), inward=True))).take(np.arange(1, 7))
    patches = rd.subdivide(scene.with_lights(sky=rd.uniform_sky(1e4)), cells=1)
    with pytest.warns(rd.RadiosityWarning, match=r"no light reached any patch in [\d,]+ lines.*does a window let the sky in"):
        solution = rd.solve(patches, method, error=0.05)
    assert solution.rays < 2e6
    assert not solution.irradiance.any()


def test_sensors_in_a_closed_room_under_a_sky(monkeypatch):
    monkeypatch.setattr(goal, "DARK", 1e5)
    scene = lit(("walls", 0.5, 0.0, box((0, 0, 0), (4, 4, 3), inward=True))).take(np.arange(1, 7))
    patches = rd.subdivide(scene.with_lights(sky=rd.uniform_sky(1e4)), cells=1)
    with pytest.warns(rd.RadiosityWarning) as told:
        found = rd.measure(patches, rd.Sensors.of([[2, 2, 1]]), error=0.1)
    text = " ".join(str(one.message) for one in told)
    assert "no light reached any patch" in text
    assert "no line found light at the sensors" in text
    assert found.status == "not reached"  # a relative error of nothing cannot be judged
    assert (found.illuminance == 0).all()
