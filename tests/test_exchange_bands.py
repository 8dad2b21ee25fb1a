"""Planck's law in bands, and exchange where emissivity depends on wavelength."""

import numpy as np
import pytest
from scipy.integrate import quad as integral
from scipy.optimize import brentq
from test_exchange import big_box, black, cubes, near, resistance

import radiosity as rd
from radiosity.exchange.planck import C2, SIGMA, band_shares, band_slopes, share_below


def spectral(t: float) -> float:
    """t³ / (e^t - 1) over its integral from zero to infinity."""
    return 15 / np.pi**4 * t**3 / np.expm1(t)


@pytest.mark.parametrize("product", [400.0, 1500.0, 2897.8, 8000.0, C2 * 0.999, C2 * 1.001, 5e4, 1e6])
def test_shares_are_the_integral_of_plancks_law(product):
    z = C2 / product
    exact = integral(spectral, z, z + 60, epsabs=0, epsrel=1e-12, limit=200)[0]
    assert share_below(product) == pytest.approx(exact, rel=1e-11)


def test_shares_at_the_ends_and_their_sum():
    assert share_below(0.0) == 0
    assert share_below(np.inf) == 1
    assert share_below(4107.0) == pytest.approx(0.5, abs=1e-3)  # the median wavelength is 4107 µm K / T
    kelvin = np.array([0.0, 3.0, 300, 3000])
    assert band_shares((2.0, 8.0), kelvin).sum(axis=0) == pytest.approx(np.ones(4), abs=1e-15)
    assert (band_shares((2.0, 8.0), kelvin) >= 0).all()


def test_slopes_are_derivatives():
    edges, kelvin, step = (3.0, 8.0, 20.0), np.array([77.0, 300, 1500]), 1e-4

    def emitted(k):
        return band_shares(edges, k) * SIGMA * k**4

    slope = (emitted(kelvin + step) - emitted(kelvin - step)) / (8 * SIGMA * kelvin**3 * step)
    assert band_slopes(edges, kelvin) == pytest.approx(slope, abs=1e-6)
    assert band_slopes(edges, kelvin).sum(axis=0) == pytest.approx(np.ones(3), abs=1e-14)


def test_two_bands_of_given_temperatures_are_two_exchanges():
    patches, edges = rd.subdivide(cubes(1.0, 1.5), cells=1), (1.0, 1.5)
    shine = {"cube 0": [0.9, 0.1], "cube 1": [0.2, 0.7]}
    heat = rd.radiative_exchange(patches, {"cube 0": 1200, "cube 1": 400}, emissivity=shine, wavelengths=[4.0], rays=100_000)
    shares = band_shares((4.0,), np.array([1200.0, 400.0]))
    exact = sum(
        (shares[b, 0] * black(1200) - shares[b, 1] * black(400)) / resistance(edges, [shine[name][b] for name in shine])
        for b in range(2)
    )
    assert near(heat.net[0], exact, heat.net_standard_error[0], of=1e-5)
    assert heat.net_standard_error[0] < 1e-3 * exact
    assert heat["cube 0"]["emissivity"] == [0.9, 0.1]


@pytest.mark.parametrize("watts", [0.0, 3000.0])
def test_the_bands_of_a_floating_shield_share_its_temperature(watts):
    """A sheet between cubes: what it takes in two bands, and from a heater, it gives off at one temperature."""
    edges = (1.0, 1.3, 1.8)
    shine = {"cube 0": [0.8, 0.8], "cube 1": [0.9, 0.1], "cube 2": [0.3, 0.9]}
    heat = rd.radiative_exchange(
        rd.subdivide(cubes(*edges), cells=1),
        {"cube 0": 1000, "cube 2": 300},
        emissivity=shine,
        wavelengths=[5.0],
        flux={"cube 1": watts},
        rays=100_000,
    )

    def flows(kelvin):
        shares = band_shares((5.0,), np.array([1000.0, kelvin, 300.0]))
        emitted = shares * black(np.array([1000.0, kelvin, 300.0]))
        inner = [(emitted[b, 0] - emitted[b, 1]) / resistance(edges[:2], [shine[f"cube {i}"][b] for i in (0, 1)]) for b in (0, 1)]
        outer = [(emitted[b, 1] - emitted[b, 2]) / resistance(edges[1:], [shine[f"cube {i}"][b] for i in (1, 2)]) for b in (0, 1)]
        return sum(inner), sum(outer)

    exact = brentq(lambda kelvin: flows(kelvin)[1] - flows(kelvin)[0] - watts, 300, 3000)
    assert heat.temperature[1] == pytest.approx(exact, rel=1e-4)
    assert near(heat.temperature[1], exact, heat.temperature_standard_error[1], of=1e-5)
    assert near(heat.net[0], flows(exact)[0], heat.net_standard_error[0], of=1e-4)
    assert abs(heat.net.sum()) < 1e-6 * heat.net[2] * -1


def test_equal_bands_are_grey():
    patches, *_ = big_box()
    options = {"temperature": {"z low": 900, "x high": 300}, "adiabatic": ["x low", "z high"], "rays": 50_000}
    options["flux"] = {"y low": 4000.0, "y high": -1000.0}
    grey = rd.radiative_exchange(patches, emissivity=0.3, **options)
    bands = rd.radiative_exchange(patches, emissivity=[0.3, 0.3, 0.3], wavelengths=[2, 6], **options)
    assert bands.temperature == pytest.approx(grey.temperature, rel=1e-8)
    assert bands.net == pytest.approx(grey.net, rel=1e-7)
    assert bands.net_standard_error == pytest.approx(grey.net_standard_error, rel=1e-4)


def test_equal_temperatures_exchange_nothing_in_any_band():
    patches, *_ = big_box()
    heat = rd.radiative_exchange(patches, {"*": 500}, emissivity=[0.1, 0.8], wavelengths=[3], adiabatic=["z high"], rays=20_000)
    assert heat.net == pytest.approx(np.zeros(6), abs=1e-7)
    assert heat.temperature[5] == pytest.approx(500, rel=1e-12)
