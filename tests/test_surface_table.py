"""The table of surfaces and the report's rows, of a solution whose numbers are made up: every column by hand."""

import numpy as np
import pytest

import radiosity as rd
from radiosity.solution.report import MOST_ROWS

NAMES = ("dark", "lamp", "empty", "wall")
REFLECTANCE = np.array([[0.0, 0.0], [0.5, 0.2], [0.4, 0.8], [0.6, 0.1]])
EMISSION = np.array([[0.0, 0.0], [10.0, 4.0], [0.0, 1.0], [0.0, 0.0]])
SURFACE = np.array([0, 1, 3, 3])


def made_up() -> rd.Solution:
    """Four squares, of 1, 4, 9 and 16 m² and a patch each, on three of four surfaces; two bands, two replicates."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    vertices = np.concatenate([corners * edge + [0, 0, edge] for edge in (1, 2, 3, 4)])
    scene = rd.Scene.from_arrays(
        vertices, np.arange(16).reshape(4, 4), REFLECTANCE, EMISSION, surface=SURFACE, names=NAMES, bands=("warm", "cold")
    )
    patches = rd.subdivide(scene, cells=1)
    irradiance = np.array([[2.0, 1.0], [3.0, 5.0], [7.0, 11.0], [13.0, 17.0]])
    error = 0.1 * irradiance
    power = np.zeros((2, 4, 2))
    for surface in range(4):
        power[:, surface] = (patches.area[:, None] * irradiance)[surface == SURFACE].sum(axis=0)
    power *= np.array([0.99, 1.01])[:, None, None]  # the two replicates lie a hundredth about their mean
    book = {"emitted": 1.0, "rounding": 0.0, "absorbed": 1.0, "escaped": 0.0, "lost": 0.0, "closes": True}
    return rd.Solution(
        patches,
        irradiance,
        error,
        np.array([0, 1, 29, 30]),
        60,
        1.0,
        100,
        2,
        (book, book),
        "complete",
        {"method": "made up", "seed": 0},
        {},
        np.stack([power, power / 2]),
    )


def test_every_column():
    solution = made_up()
    area, irradiance = np.array([1.0, 4.0, 9.0, 16.0]), solution.irradiance
    rows = {row["surface"]: row for row in solution.surface_table()}
    assert tuple(rows) == NAMES
    for i, name in enumerate(NAMES):
        row, here = rows[name], i == SURFACE
        assert (row["patches"], row["area"]) == (here.sum(), area[here].sum())
        for band, tail in enumerate((" [warm]", " [cold]")):
            received = (area * irradiance[:, band])[here].sum()
            reflected = (area * irradiance[:, band] * REFLECTANCE[:, band])[here].sum()
            emitted = (area * EMISSION[:, band])[here].sum()
            expected = {
                "emitted": emitted,
                "received": received,
                "reflected": reflected,
                "absorbed": received - reflected,
                "left": emitted + reflected,
                "net": emitted + reflected - received,
                "radiosity": (emitted + reflected) / max(area[here].sum(), 1),
                "irradiance": received / max(area[here].sum(), 1),
            }
            assert {key: row[key + tail] for key in expected} == pytest.approx(expected, rel=1e-12)
    assert [rows[name]["arrivals"] for name in NAMES] == [0, 1, 0, 59]
    assert [rows[name]["few"] for name in NAMES] == [1, 1, 0, 1]
    assert [rows[name]["unvisited"] for name in NAMES] == [1, 0, 0, 0]
    # two replicates: Student's bound for one degree of freedom times the standard error of the mean, a hundredth
    assert rows["wall"]["interval"] == pytest.approx(12.706 * 0.01, rel=1e-4)
    assert min(rows[name]["interval"] for name in ("dark", "lamp")) > 0.12706  # few lines landed there
    assert np.isnan(rows["empty"]["interval"])
    assert np.isnan(rows["empty"]["error"])
    assert rows["lamp"]["error"] == pytest.approx(0.1)
    square = (area[2:, None] * (REFLECTANCE * irradiance)[2:] ** 2).sum(axis=0)
    assert rows["wall"]["error"] == pytest.approx((0.1 * np.sqrt(square / square)).max())


def test_the_report_begins_with_what_shines_most():
    lines = made_up().report().splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("surface "))
    shown = [line.split()[0] for line in lines[start + 1 : start + 5]]
    assert shown == ["wall", "lamp", "dark", "empty"]  # by the power that leaves
    assert "B warm" in lines[start]


def test_a_report_of_many_surfaces_is_cut_off():
    corners = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    count = MOST_ROWS + 5
    scene = rd.Scene.from_arrays(
        np.concatenate([corners + np.array([3 * i, 0, 0]) for i in range(count)]),
        np.arange(4 * count).reshape(-1, 4),
        0.5,
        np.arange(1.0, count + 1),
        surface=range(count),
        names=[f"s{i}" for i in range(count)],
    )
    lines = rd.solve(rd.subdivide(scene, cells=1), "random-walk", quanta=100, replicates=2).report().splitlines()
    end = lines.index("... and 5 more surfaces (export a .csv for all)")
    assert [line.split()[0] for line in lines[end - MOST_ROWS : end]] == [f"s{i}" for i in reversed(range(5, count))]
