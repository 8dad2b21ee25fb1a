"""``radiosity solve --live``: the results are those without it, whatever becomes of the page."""

from importlib.util import find_spec

import numpy as np
import pytest

import radiosity as rd
from radiosity.cli import live, main
from radiosity.viewer import convergence

needs_viser = pytest.mark.skipif(find_spec("viser") is None, reason="viser is not installed, which shows pages")


@needs_viser
def test_the_results_are_those_without_the_page(tmp_path, capsys):
    options = [
        "solve",
        "room",
        "--cells",
        "1",
        "--method",
        "random-walk",
        "--order",
        "staged",
        "--rays",
        "20k",
        "--replicates",
        "2",
    ]
    assert main([*options, "-o", str(tmp_path / "plain.npz")]) == 0
    capsys.readouterr()
    assert main([*options, "--live", "--port", "0", "-o", str(tmp_path / "live.npz")]) == 0
    out, err = capsys.readouterr()
    assert out.startswith("http://localhost:")
    assert "Ctrl-C ends the run early" in out
    assert err == ""
    plain, shown = (rd.load_solution(tmp_path / f"{name}.npz") for name in ("plain", "live"))
    for name in ("irradiance", "irradiance_standard_error", "arrivals"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(shown, name))
    assert all(np.array_equal(plain.state[key], shown.state[key]) for key in plain.state)
    assert (plain.quanta, plain.rays, plain.status) == (shown.quanta, shown.rays, shown.status)


@needs_viser
def test_the_page_follows_the_run(tmp_path):
    from radiosity.viewer.live import Live

    patches = rd.subdivide(rd.load_scene("room"), cells=1)
    with rd.view(patches, port=0) as viewer:
        assert viewer.page.content.subject.solution is None
        page = Live(viewer)
        options = {"order": "staged", "rays": 20_000, "replicates": 2}
        solution = rd.solve(patches, "random-walk", **options, watch=page.watch, progress=page.progress)
        page.finish(solution)
        assert viewer.page.settled(20)
        assert len(page.errors) > 3
        assert page.errors[-1] == pytest.approx(100 * solution.error)
        assert viewer.page.content.subject.solution is solution
        parts = viewer.panel.parts
        assert parts["run"].content.startswith(f"**complete** after {solution.rays:,} lines")
        assert parts["quantity"].value == "radiosity"
        assert parts["plot"].image.shape == convergence.plot(page.rays, page.errors).shape


def test_faults_of_the_page_end_nothing(capsys):
    class Broken:
        def watch(self, solution):
            raise ZeroDivisionError("no page")

        progress = finish = watch

    seen = []
    told = live.listeners(Broken(), seen.append)
    patches = rd.subdivide(rd.load_scene("room"), cells=1)
    solution = rd.solve(patches, "random-walk", rays=20_000, replicates=1, **told)
    assert solution.status == "complete"
    assert seen, "the bar of the terminal goes on"
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 2
    assert said[0] == "radiosity: warning: the page of --live does not follow: ZeroDivisionError: no page; the run goes on"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--port", "9000"], "--port: of the page that --live shows; add --live"),
        (["--live", "--refine-check"], "--live shows one run, and --refine-check makes two; leave one of them out"),
    ],
)
def test_what_does_not_go_together_is_refused(options, message, capsys):
    assert main(["solve", "room", *options]) == 2
    assert message in capsys.readouterr().err


def test_who_listens_to_a_run_changes_nothing():
    """The number of lines decides how the last stage is chosen: it is the same whoever asks for errors between stages."""
    patches, options = rd.subdivide(rd.load_scene("room"), cells=1), {"order": "staged", "rays": 20_000, "replicates": 2}
    plain, told = (rd.solve(patches, "random-walk", **options, progress=listener) for listener in (None, lambda state: None))
    assert told.quanta == plain.quanta
    np.testing.assert_array_equal(told.irradiance, plain.irradiance)
