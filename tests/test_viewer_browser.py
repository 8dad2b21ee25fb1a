"""The viewer in a real browser: what its pixels show, and what clicks do. One server and one page serve all tests."""

import re
import time
from pathlib import Path

import numpy as np
import pytest
from browsers import PATIENCE, SIZE, browser, needed, pixels, pixels_of

import radiosity as rd
from radiosity.image import tone
from radiosity.image.view import project
from radiosity.viewer import eye
from radiosity.viewer.shades import Shades

pytestmark = needed
FREE = 520  # pixels from the left that the panel leaves free
CAMERA = rd.Camera((3.0, -6.0, 1.5), (3.0, 0.0, 1.5), fov=50, **SIZE)


def box() -> rd.Scene:
    """A room without a south wall, whose north wall is three panels that emit unlike light, and a floor."""
    wall = [[[2 * i, 2, 0], [2 * i + 2, 2, 0], [2 * i + 2, 2, 3], [2 * i, 2, 3]] for i in range(3)]
    floor = [[0, 0, 0], [6, 0, 0], [6, 2, 0], [0, 2, 0]]
    corners = np.array([*[corner for panel in wall for corner in panel], *floor], float)
    return rd.Scene.from_arrays(
        corners,
        np.arange(16).reshape(4, 4),
        reflectance=0.5,
        emission=np.array([100.0, 10, 1, 0])[:, None],
        surface=np.arange(4),
        names=["left", "middle", "right", "<b>floor</b>"],
        cameras=(CAMERA,),
    )


def until(happened) -> None:
    """Wait until something has happened."""
    since = time.monotonic()
    while not happened():
        assert time.monotonic() - since < PATIENCE, "it did not happen"
        time.sleep(0.05)


class Shown:
    """A page in a browser, and its viewer."""

    def __init__(self, context, viewer, solution):
        self.context, self.viewer, self.solution = context, viewer, solution
        self.page = context.pages[0]
        self.asked = []
        context.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(f"{viewer.url}/?fixedDpr=1")  # a page whose machine is busy is else drawn in fewer pixels
        self.page.wait_for_selector("canvas")
        self.page.get_by_text("Software WebGL").wait_for()
        self.page.add_style_tag(content=".mantine-Notification-root {display: none !important}")

    def steady(self) -> np.ndarray:
        """Return the page's pixels once all was sent, and the picture no longer changes."""
        assert self.viewer.page.settled(PATIENCE)
        before, since = pixels(self.page), time.monotonic()
        while time.monotonic() - since < PATIENCE:
            time.sleep(0.15)
            now = pixels(self.page)
            if np.array_equal(now[:, :FREE], before[:, :FREE]) and now[:, :FREE].any():
                return now
            before = now
        raise AssertionError("the page goes on to change")

    def look(self, **changes) -> np.ndarray:
        """Change the look, and return the page's pixels."""
        self.viewer.page.change(**changes)
        return self.steady()

    def press(self, button: str, hidden: set[int]) -> None:
        """Press a button of the panel, after which these surfaces are hidden."""
        self.page.get_by_text(button, exact=True).click()
        until(lambda: self.viewer.page.look.hidden == hidden)

    def places(self, patches) -> np.ndarray:
        """Return the pixels (x, y) of the middles of patches."""
        return np.rint(project(CAMERA, self.solution.patches.centroid[patches])[:, :2]).astype(int)


@pytest.fixture(scope="module")
def shown():
    solution = rd.solve(rd.subdivide(box(), cells=2), "random-walk", rays=40_000, replicates=2)
    with rd.view(solution, port=0, smooth=False) as viewer, browser() as context:
        yield Shown(context, viewer, solution)


@pytest.fixture
def plain(shown):
    """The page as it was at first."""
    yield shown
    shown.viewer.page.change(shades=Shades(), smooth=False, hidden=frozenset(), wireframe=False, cut=None, quantity=None)


def seen(shown) -> np.ndarray:
    """Return the patches whose middles the panel leaves free."""
    everything = np.arange(len(shown.solution.patches))
    x, y = shown.places(everything).T
    return everything[(x > 5) & (x < FREE) & (y > 5) & (y < SIZE["height"] - 5)]


@pytest.mark.parametrize("log", [False, True])
def test_the_middle_of_a_patch_has_the_colour_of_the_legend(plain, log):
    found = plain.look(quantity="irradiance", shades=Shades(True, log, (0.5, 60.0)))
    patches = seen(plain)
    x, y = plain.places(patches).T
    colours = plain.viewer.panel.colours
    wanted = tone.eight_bits(colours.palette(plain.solution.irradiance[patches, 0])).astype(int)
    assert len(patches) >= 6
    assert len(np.unique(wanted, axis=0)) >= 5
    assert np.abs(found[y, x] - wanted).max() <= 2
    legend = plain.viewer.panel.parts["legend"]
    assert legend.visible
    drawn = pixels_of(plain.page.locator("img").last.screenshot()).reshape(-1, 3)
    bar = np.unique(drawn[np.ptp(drawn, axis=1) > 20], axis=0)  # coloured pixels of the bar, as the browser shows it
    assert len(bar) > 100
    assert np.abs(wanted[:, None] - bar).max(axis=2).min(axis=1).max() <= 3


def test_the_light_itself_has_the_colours_of_a_picture(plain):
    """The page beside `render` from the same camera, by the same scale."""
    found = plain.look()
    scale = plain.viewer.panel.colours.scale
    wanted = rd.image.render(plain.solution, camera=CAMERA, smooth=False, scale=scale).astype(int)
    unlike = np.abs(found - wanted)[:, :FREE].max(axis=2) > 2
    assert wanted[:, :FREE].any(axis=2).mean() > 0.3
    assert unlike.mean() < 0.02  # edges


def test_a_click_tells_the_numbers_of_a_patch(plain):
    plain.look()
    patch = int(seen(plain)[0])
    x, y = plain.places([patch])[0]
    plain.page.mouse.click(int(x), int(y))
    row = plain.page.get_by_text(re.compile(rf"^{patch}, {plain.solution.patches.face[patch]}$"))
    row.wait_for()
    assert plain.page.get_by_text(f"{plain.solution.radiosity[patch, 0]:.4g} W/m²").first.is_visible()
    plain.page.mouse.click(5, 5)
    plain.page.get_by_text("nothing there").wait_for()


def test_names_are_shown_as_they_are(plain):
    floor = np.flatnonzero(plain.solution.patches.surface == 3)
    x, y = plain.places(floor[:1])[0]
    plain.page.mouse.click(int(x), int(y))
    plain.page.get_by_text("<b>floor</b>").first.wait_for()


def test_surfaces_are_hidden_and_shown_by_buttons(plain):
    whole = plain.look()
    patch = int(np.flatnonzero(plain.solution.patches.surface == 0)[0])
    x, y = plain.places([patch])[0]
    plain.page.mouse.click(int(x), int(y))
    plain.page.get_by_text(re.compile(rf"^{patch}, ")).wait_for()
    plain.press("hide", {0})
    assert not plain.steady()[y, x].any()
    plain.press("only this", {1, 2, 3})
    only = plain.steady()
    assert np.array_equal(only[y, x], whole[y, x])
    assert (only[:, :FREE].any(axis=2)).sum() < (whole[:, :FREE].any(axis=2)).sum() / 2
    plain.press("all", set())
    assert (plain.steady() != whole)[:, :FREE].any(axis=2).mean() < 0.02


def test_edges_and_cuts_are_drawn(plain):
    from radiosity.viewer.picking import Cut

    whole = plain.look()
    edges = plain.look(wireframe=True)
    assert 200 < (np.abs(edges - whole).max(axis=2)[:, :FREE] > 10).sum() < 20_000
    cut = plain.look(wireframe=False, cut=Cut(2, 1.5))
    x, y = plain.places(np.arange(4)).T  # of the left panel: two rows, below and above the cut
    assert cut[y, x].any(axis=1).tolist() == [True, True, False, False]


def test_the_picture_that_is_saved_is_what_is_seen(plain, tmp_path):
    found = plain.look(shades=Shades(false=True), quantity="irradiance")
    plain.page.get_by_text("View", exact=True).first.click()
    with plain.page.expect_download() as waiting:
        plain.page.get_by_role("button", name="Save picture (PNG)").click()
    waiting.value.save_as(tmp_path / "view.png")
    saved = pixels_of((tmp_path / "view.png").read_bytes())
    assert saved.shape[1] > SIZE["width"], "a legend is beside it"
    x, y = plain.places(seen(plain)).T
    np.testing.assert_array_equal(saved[y, x], found[y, x])
    unlike = np.abs(saved[: SIZE["height"], :FREE] - found[:, :FREE]).max(axis=2) > 2
    assert unlike.mean() < 0.02  # edges
    from PIL import Image

    text = Image.open(tmp_path / "view.png").text["options"]
    assert "--origin 3,-6,1.5" in text
    assert f"--fov 50 --width {SIZE['width']} --height {SIZE['height']}" in text


def test_the_exported_page_needs_no_network(plain, tmp_path):
    found = plain.look(shades=Shades(false=True), quantity="irradiance")
    path = plain.viewer.save_html(tmp_path / "page.html")
    page = plain.context.new_page()
    plain.asked.clear()
    page.goto(path.as_uri())
    page.wait_for_selector("canvas")
    page.add_style_tag(content=".mantine-Notification-root {display: none !important}")
    patches = seen(plain)
    x, y = plain.places(patches).T
    since = time.monotonic()
    while time.monotonic() - since < PATIENCE and not np.array_equal(pixels(page)[y, x], found[y, x]):
        time.sleep(0.2)
    assert np.array_equal(pixels(page)[y, x], found[y, x])
    assert page.locator("#radiosity-legend img").is_visible()
    assert all(url.startswith(("file:", "data:", "blob:")) for url in plain.asked), plain.asked
    page.close()


def test_a_page_of_another_site_is_refused(plain):
    other = plain.context.new_page()
    other.goto(Path(__file__).as_uri())
    script = """url => new Promise(done => {
        const socket = new WebSocket(url, 'viser-v' + VERSION);
        let taken = 0;
        socket.onmessage = () => taken++;
        socket.onclose = event => done([event.code, taken]);
        setTimeout(() => done(['open', taken]), 5000);
    })"""
    from importlib.metadata import version

    code, taken = other.evaluate(script.replace("VERSION", f"'{version('viser')}'"), plain.viewer.url.replace("http", "ws"))
    other.close()
    assert code == 1008
    assert taken == 0


def test_the_camera_of_the_page_is_that_of_the_scene(plain):
    client = next(iter(plain.viewer.server.get_clients().values()))
    found = eye.seen_by(client, plain.viewer.page.content.frame)
    np.testing.assert_allclose(found.origin, CAMERA.origin, atol=1e-9)
    assert (found.fov, found.width, found.height) == (pytest.approx(CAMERA.fov), SIZE["width"], SIZE["height"])
