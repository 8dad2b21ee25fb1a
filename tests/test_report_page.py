"""Reports for clients: one page without outside references, escaped, accessible, the same bytes again, with the right figures."""

from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import main
from radiosity.report_page import pdf
from radiosity.report_page.drawing import new_figure
from radiosity.report_page.levels import plans
from radiosity.report_page.markup import element, text
from radiosity.report_page.page import _sensors, _summary
from radiosity.report_page.plans import highest, isolines, plan_views
from radiosity.report_page.quality import certainty, spot_error, to_know
from radiosity.report_page.sensor_sets import of_table
from radiosity.report_page.sensors import sensor_tables
from radiosity.report_page.surfaces import surface_tables
from radiosity.report_page.wishes import Wishes
from radiosity.report_page.words import Words, number, percent
from radiosity.sensors.isolines import draw
from radiosity.solution.percent import margin

EVIL = 'a<script>alert("x")</script>&\u202e'
ROOM = rd.load_scene("room")
WISHES = {"title": f"Title {EVIL}", "client": "A & B", "remarks": "<i>one</i>\ntwo", "width": 60, "check": False}


class Page(HTMLParser):
    """What a page holds: tags with attributes, and its text."""

    def __init__(self, page: str):
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.words = ""
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.words += data

    def all(self, tag: str) -> list[dict]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def solution():
    """The room with a photometric light, and a floor of a hostile name."""
    names = tuple(EVIL if name == "floor" else name for name in ROOM.names)
    scene = replace(ROOM, names=names, photometric=True, source="/home/somebody/secret/room.mgf")
    return rd.solve(rd.subdivide(scene, cells=4), rays=400_000)


@pytest.fixture(scope="module")
def page(solution, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "r.html"
    rd.write_report(solution, path, **WISHES)
    return path.read_text(encoding="utf-8")


def test_a_page_needs_nothing_else_and_runs_nothing(page):
    found = Page(page)
    assert not {"script", "link", "iframe", "object", "a", "form", "i"} & {tag for tag, _ in found.tags}
    assert all(one["src"].startswith("data:image/png;base64,") for one in found.all("img"))
    assert "url(" not in page
    assert "http:" not in page
    assert "https:" not in page
    assert not any(name.startswith("on") for _, attributes in found.tags for name in attributes)
    assert "\u202e" not in page
    assert 'a<script>alert("x")</script>&' in found.words  # as text
    assert "somebody" not in page


def test_a_page_can_be_read_aloud(page):
    found = Page(page)
    assert found.all("html") == [{"lang": "en"}]
    assert len(found.all("img")) >= 4
    assert all(len(one["alt"]) > 10 for one in found.all("img"))
    assert all(one.get("scope") in ("col", "row") for one in found.all("th"))
    assert len(found.all("caption")) == len(found.all("table")) >= 3
    order = [tag for tag, _ in found.tags if tag in ("h1", "h2", "h3")]
    assert order[0] == "h1"
    assert order.count("h1") == 1


def test_equal_solutions_give_equal_bytes(solution, page, tmp_path):
    rd.write_report(solution, tmp_path / "again.html", **WISHES)
    assert (tmp_path / "again.html").read_text(encoding="utf-8") == page


def test_figures_are_those_of_the_solution(solution, page):
    words = Page(page).words
    emitted = solution.books[0]["emitted"]
    assert f"{number(emitted)} lm" in words
    floor = next(row for row in solution.surface_table() if row["surface"] == EVIL)
    assert f"{number(floor['irradiance'])} lx" in words
    cells = str(surface_tables(solution, 100))
    assert f">{number(floor['radiosity'] / np.pi)}</td>" in cells  # luminance of a diffuse surface
    assert f">{number(floor['received'])}</td>" in cells
    assert solution.provenance["scene"] in words


def test_a_plan_has_the_mean_of_its_surface(solution):
    (plan,) = plans(solution, (EVIL,))
    assert plan.extent == pytest.approx((0, 6, 0, 4), abs=1e-9)
    floor = next(row for row in solution.surface_table() if row["surface"] == EVIL)
    assert np.isfinite(plan.values).all()  # boxes stand on it, and light is there on the patches below them, too
    assert np.mean(plan.values) == pytest.approx(floor["irradiance"], rel=0.05)
    with pytest.raises(rd.MethodError, match="level"):
        plans(solution, ("south wall",))
    with pytest.raises(rd.MethodError, match="no surface is called"):
        plans(solution, ("cellar",))


def test_lamps_are_no_places_to_work_at():
    """The upper side of a lamp has a plan only where it is asked for, and no figure on the first page."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    corners = np.concatenate([square, 0.5 * square + np.array([0.2, 0.2, 1]), square[::-1] + np.array([0, 0, 2])])
    faces = np.arange(12).reshape(3, 4)
    emission, names = np.array([0, 50.0, 0])[:, None], ["floor", "lamp", "ceiling"]
    scene = rd.Scene.from_arrays(corners, faces, surface=[0, 1, 2], reflectance=0.5, emission=emission, names=names)
    found = rd.solve(rd.subdivide(scene, cells=2), "random-walk", rays=5_000, replicates=2)
    assert [plan.name for plan in plans(found, ())] == ["floor"]
    assert [plan.name for plan in plans(found, ("lamp",))] == ["lamp"]
    assert "irradiance, lamp" not in str(_summary(found, []))
    assert "irradiance, floor" in str(_summary(found, []))


def test_the_error_of_a_spot_is_the_median_over_the_lit_area(solution):
    """Half of the lit area is known better: not the error of the few patches that are bright."""
    low, high = (end[:, 0] for end in solution.interval(0.95, "irradiance"))
    value, area = solution.irradiance[:, 0], solution.patches.area
    lit = ~solution.sides.left_out & (value > 0)
    better = area[lit & ((high - low) / 2 < spot_error(solution) * value)].sum()
    assert 0.45 < better / area[lit].sum() <= 0.5
    assert f"typical error of a single spot is ± {percent(spot_error(solution))}" in str(certainty(solution))


def test_isolines_leave_out_the_lowest_value():
    """A dark place has no line at 0 along its noise, and even light none at all."""
    from matplotlib.figure import Figure

    x = np.arange(8.0)
    axes = Figure().subplots()
    draw(axes, x, x, np.clip(np.add.outer(x, x) - 6, 0, None))
    assert len(axes.collections) == 1
    assert axes.collections[0].levels.min() > 0
    even = Figure().subplots()
    draw(even, x, x, np.ones((8, 8)))
    assert not even.collections


def test_few_bright_places_set_no_range_of_a_plan():
    values = np.add.outer(np.arange(20.0), np.arange(20.0))
    values[0, 0] = np.nan
    assert highest(values) == 38
    values[5, 5] = 1e5
    assert highest(values) == pytest.approx(np.nanpercentile(values, 99))
    drawing = new_figure(3, 3)
    axes = drawing.subplots()
    isolines(axes, drawing, values, (0, 1, 0, 1), "light [lx]")
    assert axes.images[0].get_clim()[1] == highest(values)
    assert drawing.axes[1].get_ylabel() == "light [lx]; arrow: brighter than 99 % of the area"
    assert len(axes.collections[0].levels) > 4, "isolines are where most of the light is"


def test_plans_of_scenes_with_y_up_are_seen_from_above():
    """A floor that is twice as bright on one half: in the plan that half lies where -z is up."""
    corners = [[0, 0, 0], [0, 0, 2], [1, 0, 2], [1, 0, 0]]
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], 0.5, 1.0, names=["floor"], source="x.glb")
    solution = rd.solve(rd.subdivide(scene, cells=2), rays=10_000)
    bright = np.where(solution.patches.centroid[:, 2:] < 1, 2.0, 1.0)
    (plan,) = plans(replace(solution, irradiance=bright, arrivals=np.full(4, 999)), ())
    assert plan.axes == ("x", "-z")
    assert plan.extent == pytest.approx((0, 1, -2, 0))
    assert np.nanmean(plan.values[-5:]) > 1.9
    assert np.nanmean(plan.values[:5]) < 1.1
    assert not plan.unknown.any()


def test_plans_are_grey_where_no_line_came():
    """A value of 0 that no line brought is unknown; the mean counts it, as that of the surface does."""
    corners = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]]
    scene = rd.Scene.from_arrays(corners, [[0, 1, 2, 3]], 0.5, 1.0, names=["floor"])
    solution = rd.solve(rd.subdivide(scene, cells=6), rays=1_000)
    lit = solution.patches.centroid[:, 0] < 1
    few = replace(solution, irradiance=3.0 * lit[:, None], arrivals=100 * lit)
    (plan,) = plans(few, ())
    page = str(plan_views(few, ()))
    assert plan.unknown.mean() == pytest.approx(1 / 3, abs=0.02)  # smoothed values reach a patch beyond the lit ones
    assert not plan.unknown[:, : plan.values.shape[1] // 2].any()
    assert plan.mean == pytest.approx(1.5, rel=0.05)
    assert f"{percent(plan.unknown.mean())} of it, grey, is unknown: no line came there" in page
    (known,) = plans(replace(few, arrivals=np.full(36, 100)), ())
    assert not known.unknown.any()
    assert np.nanmin(known.values) == 0
    nothing = replace(few, irradiance=np.zeros((36, 1)), arrivals=np.zeros(36, int))
    assert "no line came there, so its irradiance is unknown" in str(plan_views(nothing, ("floor",)))


TABLE = (
    "set,x_m,y_m,z_m,nx,ny,nz,kind,inside,illuminance_lx,half_width_95_lx\n"
    + "".join(f"plane,{x},{y},0.8,0,0,1,plane,{int(x == 3)},{100 * (x + 1) + y},2\n" for x in range(4) for y in range(3))
    + "eye,1,1,1.2,0,1,0,plane,0,321,nan\n"
)


def test_tables_of_sensors_are_read_and_shown(tmp_path):
    (tmp_path / "lux.csv").write_text(TABLE)
    plane, eye = of_table(tmp_path / "lux.csv", photometric=True)
    assert (plane.name, len(plane.values), plane.inside) == ("plane", 9, 3)
    found = Page(str(sensor_tables([plane, eye], Words.of(replace(ROOM, photometric=True)))))
    assert "0.50" in found.words  # 100 over the mean of 201
    assert "100201302" in found.words.replace("\n", "")
    assert "plane (3)" in found.words  # inside of something
    assert len(found.all("img")) == 1  # a map of the lattice
    assert "321" in found.words


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("a,b\n1,2\n", "no column illuminance_lx"),
        (TABLE.replace("illuminance_lx", "irradiance_W/m2"), "another unit"),
        (TABLE.replace("321", "many"), "not understood"),
        (TABLE.replace("321", "inf"), "not finite"),
        ("", "no rows"),
    ],
)
def test_other_tables_are_refused(tmp_path, content, says):
    (tmp_path / "lux.csv").write_text(content)
    with pytest.raises(rd.SceneError, match=says):
        of_table(tmp_path / "lux.csv", photometric=True)


def test_sensors_that_the_scene_asks_for_are_measured():
    from radiosity.scene.sensor_request import SensorRequest

    request = SensorRequest("desk", points=((1.0, 1.0, 1.0),), normals=((0.0, 0.0, 1.0),))
    solution = rd.solve(rd.subdivide(replace(ROOM, sensors=(request,)), cells=2), rays=50_000)
    (desk,) = _sensors(solution, Wishes(), None)
    assert (desk.name, len(desk.values)) == ("desk", 1)
    assert desk.values[0] > 0
    assert _sensors(solution, Wishes(sensors=False), None) == []


def test_warnings_stand_on_the_page(solution):
    wrong = replace(
        solution,
        status="interrupted",
        books=tuple({**book, "closes": False} for book in solution.books),
        patches=replace(solution.patches, scene=replace(solution.patches.scene, assumed=("shelf",))),
        arrivals=np.where(np.arange(len(solution.patches)) < 16, 0, solution.arrivals),
    )
    words = Page(str(to_know(wrong, None, ["a lens is missing"]))).words
    for sentence in ("ended early: interrupted", "not to be trusted", "assumed: shelf", "was not checked", "a lens is missing"):
        assert sentence in words
    assert "16 of 288 patches" in words
    leaky = rd.check(ROOM.take(np.arange(ROOM.n_faces) > 0))
    assert "leave the scene" in Page(str(to_know(solution, leaky, []))).words
    assert "Nothing unusual" in Page(str(to_know(solution, rd.check(ROOM), []))).words


def test_a_baseline_shows_how_it_converged():
    solution = rd.solve(rd.subdivide(ROOM, cells=2), "full-matrix")
    found = Page(str(certainty(solution)))
    assert any("Convergence" in one["alt"] for one in found.all("img"))
    assert "solves the equations directly" in found.words


def test_numbers_are_those_that_people_read():
    assert [margin(value) for value in (27.0, 0.0164, 1234.0, np.nan)] == ["30", "0.02", "1000", "?"]
    values = (0, 0.012345, 1.2345, 12.345, 123.45, 12345.6, 9.999, 0.9996, 2.5e7, 1e-5, float("nan"))
    shown = ["0", "0.0123", "1.23", "12.3", "123", "12,300", "10.0", "1.00", "2.50e+07", "1.00e-05", "unknown"]
    assert [number(value) for value in values] == shown
    assert [percent(share) for share in (0.0123, 0.5, 1.7, float("nan"))] == ["1.2 %", "50 %", "over 100 %", "unknown"]


def test_text_is_escaped_once():
    assert element("p", "<&>", element("b", "x"), title='"') == '<p title="&quot;">&lt;&amp;&gt;<b>x</b></p>'
    assert text("\x00\ud800") == "\ufffd\ufffd"


def printed(page: str, path) -> bytes:
    try:
        pdf.write(page, path)
    except rd.OutputError as error:
        if "none is found" in str(error):
            pytest.skip(str(error))
        raise
    return path.read_bytes()


def test_a_pdf_is_printed(page, tmp_path):
    data = printed(page, tmp_path / "r.pdf")
    assert data.startswith(b"%PDF")
    assert len(data) > 10_000
    assert b"D:20000101" in data  # no clock


@pytest.mark.slow
def test_the_same_page_is_printed_alike(page, tmp_path):
    assert printed(page, tmp_path / "one.pdf") == printed(page, tmp_path / "two.pdf")


def test_the_command_writes_a_page(solution, tmp_path):
    solution.save(tmp_path / "room.npz")
    asked = ["--no-check", "--width", "60", "--plan", "a<*", "--title", "Mine", "--client", "A & B"]
    assert main(["report", str(tmp_path / "room.npz"), *asked, "-o", str(tmp_path / "r.html")]) == 0
    assert "<h1>Mine</h1>" in (tmp_path / "r.html").read_text(encoding="utf-8")


def test_pdfs_of_other_moments_and_runs_are_equal():
    one = b"/ID (node00000012) /ID (node00000013)\n/CreationDate (D:20261128141500+00'00')\n/K (node00000012)"
    other = b"/ID (node00000015) /ID (node00000019)\n/CreationDate (D:20261129000000+00'00')\n/K (node00000015)"
    assert pdf.repeatable(one) == pdf.repeatable(other)
    assert len(pdf.repeatable(one)) == len(one)
    assert b"(node00000000) /ID (node00000001)" in pdf.repeatable(one)


def test_what_cannot_be_written_is_said_before_any_work(solution, tmp_path, monkeypatch):
    monkeypatch.setattr(pdf, "PLACES", ())
    monkeypatch.setattr("shutil.which", lambda name: None)
    with pytest.raises(rd.OutputError, match="none is found"):
        rd.write_report(solution, tmp_path / "r.pdf")
    for wrong, says in (
        ((), "no output"),
        (("r.docx",), "unknown output format"),
        (("r.html", "r.html"), "named twice"),
    ):
        with pytest.raises(rd.OutputError, match=says):
            rd.write_report(solution, *(tmp_path / name for name in wrong))
    with pytest.raises(rd.MethodError, match="no 'colour'"):
        rd.write_report(solution, tmp_path / "r.html", colour="red")
    with pytest.raises(rd.MethodError, match="width"):
        rd.write_report(solution, tmp_path / "r.html", width=0)
    assert main(["report", str(tmp_path / "no.npz"), "-o", str(tmp_path / "r.html")]) == 2


def test_plans_leave_out_what_boxes_stand_on():
    """The floor under a box is no place with the least light; it is none at all."""
    solution = rd.solve(rd.adapt(rd.load_scene("cornell-box"), 300), "random-walk", rays=60_000)
    (plan,) = plans(solution, ("floor",))
    left, right, bottom, top = plan.extent
    shown = np.isfinite(plan.values).mean() * (right - left) * (top - bottom)
    boxes = 0.013768 + 0.013865 + 0.0138405 + 0.013786  # m², of their tops, as large as what they stand on
    assert shown == pytest.approx(plan.area - boxes, rel=0.02)
    assert np.nanmin(plan.values) > 0
