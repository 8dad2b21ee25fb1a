"""Heat through panes, against closed forms: the network takes the solid part of a pane."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.exchange.planck import SIGMA
from radiosity.factors.polygons import exchange

GROUPS = {name: [name] for name in ("hot", "cold", "pane")}
HOT, COLD, AROUND = 400.0, 300.0, 250.0
SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)


def at(height):
    return SQUARE + np.array([0, 0, height])


def plates(transmittance, reflectance, emissivity=(0.7, 0.4)) -> rd.Scene:
    """Two square plates 1 m apart, whose fronts face each other, and a two-sided pane of their size midway."""
    corners = np.concatenate([at(0), at(1)[::-1], at(0.5)])
    rho = [1 - emissivity[0], 1 - emissivity[1], reflectance]
    return rd.Scene.from_arrays(
        corners,
        np.arange(12).reshape(3, 4),
        np.array(rho),
        0.0,
        surface=range(3),
        names=["hot", "cold", "pane"],
        two_sided=[True, True, True],
        transmittance=np.array([0, 0, transmittance]),
    )


def whole_panes(t, rho, one, two):
    """The exchange of `plates` in equations of whole panes; also W that each plate gives off in front, and the pane's K.

    Unknown are B of both plates, B of both sides of the pane, and what a black pane would emit. A line from plate to plate goes
    through the pane, since the midway square holds all of them.
    """
    half, whole = (float(exchange(at(0)[None], at(gap)[::-1][None])[0]) for gap in (0.5, 1.0))
    hot, cold, around = SIGMA * HOT**4, SIGMA * COLD**4, SIGMA * AROUND**4
    eps = 1 - rho - t
    beside = (1 - half + t * (half - whole)) * around
    sees = np.zeros((4, 4))  # irradiance of hot, cold, pane's side to hot, to cold: of what these send
    sees[0] = [0, t * whole, half, 0]
    sees[1] = [t * whole, 0, 0, half]
    sees[2] = [half, 0, 0, 0]
    sees[3] = [0, half, 0, 0]
    fixed = np.array([beside, beside, (1 - half) * around, (1 - half) * around])
    shine = np.array([1 - one, 1 - two, rho, rho])
    matrix, right = np.eye(5), np.zeros(5)
    matrix[:4, :4] -= shine[:, None] * sees
    right[:4] = shine * fixed + [one * hot, two * cold, 0, 0]
    matrix[2:4, 4] = -eps
    matrix[4] = [*-(sees[2] + sees[3]), 2]  # the pane emits as much as it absorbs
    right[4] = fixed[2] + fixed[3]
    found = np.linalg.solve(matrix, right)
    given_off = found[:4] - sees @ found[:4] - fixed
    return given_off[:2] + np.array([one * (hot - around), two * (cold - around)]), (found[4] / SIGMA) ** 0.25


@pytest.mark.parametrize(("t", "rho"), [(0.3, 0.5), (0.8, 0.05), (0.5, 0.0)])
def test_a_floating_pane_between_plates(t, rho):
    """Four standard errors, at 2 % of the heat at most; backs of the plates send to the surroundings."""
    scene = plates(t, rho)
    eps = 1 - rho - t
    heat = rd.radiative_exchange(
        rd.subdivide(scene, cells=1),
        {"hot": HOT, "cold": COLD},
        emissivity={"hot": 0.7, "cold": 0.4, "pane": eps},
        adiabatic=["pane"],
        surroundings=AROUND,
        rays=300_000,
        seed=2,
    )
    net, pane = whole_panes(t, rho, 0.7, 0.4)
    error = heat.net_standard_error
    assert (np.abs(heat.net[:2] - net) < 4 * error[:2] + 1e-6).all()
    assert (error[:2] < 0.02 * np.abs(net)).all()
    assert heat.net[2] == 0
    assert heat.temperature[2] == pytest.approx(pane, abs=4 * heat.temperature_standard_error[2] + 1e-6)
    assert heat.net.sum() + heat.surroundings_net == pytest.approx(0, abs=1e-9 * np.abs(net).max())
    assert heat.area[2] == 2.0


def test_equal_temperatures_exchange_nothing():
    heat = rd.radiative_exchange(
        rd.subdivide(plates(0.4, 0.3), cells=1), {"*": 300}, emissivity={"*": 0.5, "pane": 0.3}, surroundings=300, rays=1e4
    )
    assert (heat.net == 0).all()


def test_gebhart_factors_of_a_pane():
    """Rows sum to one, conductors are the same both ways as far as lines tell, and a black half-clear pane absorbs half."""
    lines = rd.trace_lines(rd.subdivide(plates(0.5, 0.0, (1.0, 1.0)), cells=1), rays=400_000, seed=2)
    shares = rd.gebhart_factors(lines, emissivity={"*": 1.0, "pane": 0.5}, group=GROUPS)
    half, whole = (float(exchange(at(0)[None], at(gap)[::-1][None])[0]) for gap in (0.5, 1.0))
    expected = np.array([[0, 0.5 * whole / 2, 0.5 * half / 2], [0.5 * whole / 2, 0, 0.5 * half / 2], [half / 2, half / 2, 0]])
    assert shares.matrix == pytest.approx(expected, abs=4e-3)
    assert shares.conductors == pytest.approx(shares.conductors.T, abs=6e-3)
    assert shares.values.sum(axis=1) == pytest.approx(np.ones(3))


def test_view_factors_count_the_solid_part():
    """Rows sum to one; a plate sees t F of the other, and the solid part of the pane; reciprocity is with its area."""
    factors = rd.view_factors(rd.subdivide(plates(0.5, 0.0), cells=1), rays=400_000, seed=2, group=GROUPS)
    half, whole = (float(exchange(at(0)[None], at(gap)[::-1][None])[0]) for gap in (0.5, 1.0))
    assert factors.area.tolist() == [2.0, 2.0, 1.0]
    expected = np.array([[0, 0.5 * whole / 2, 0.5 * half / 2], [0.5 * whole / 2, 0, 0.5 * half / 2], [half / 2, half / 2, 0]])
    assert factors.matrix == pytest.approx(expected, abs=4e-3)
    exchanged = factors.restored().matrix * factors.area[:, None]
    assert exchanged == pytest.approx(exchanged.T, abs=1e-9)


def test_emissivity_of_a_pane():
    """Without one it is 1 - reflectance - transmittance; more than 1 - transmittance is refused."""
    patches = rd.subdivide(plates(0.4, 0.3), cells=1)
    with pytest.warns(rd.RadiosityWarning, match="1 - reflectance - transmittance is taken"):
        heat = rd.radiative_exchange(patches, {"*": 300}, surroundings=280, rays=1e4)
    assert heat.emissivity[:, 0] == pytest.approx([0.7, 0.4, 0.3])
    with pytest.raises(rd.SceneError, match=r"'pane' has emissivity 0\.9 and transmittance 0\.4, above 1"):
        rd.radiative_exchange(patches, {"*": 300}, emissivity=0.9, surroundings=280, rays=1e4)


def test_files_of_heat_keep_panes(tmp_path):
    patches = rd.subdivide(plates(0.4, 0.3), cells=1)
    heat = rd.radiative_exchange(patches, {"*": 300}, emissivity={"*": 0.5, "pane": 0.3}, surroundings=280, rays=1e4)
    heat.save(tmp_path / "heat.npz")
    again = rd.load_exchange(tmp_path / "heat.npz")
    assert again.patches.scene.transmittance.tolist() == [0, 0, 0.4]
    lines = rd.trace_lines(patches, rays=1e4)
    lines.save(tmp_path / "lines.npz")
    assert rd.load_lines(tmp_path / "lines.npz").patches.scene.geometry_hash == patches.scene.geometry_hash
