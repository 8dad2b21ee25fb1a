"""The documentation tells the truth: the tutorial and the examples of docstrings run, and every link leads somewhere."""

import doctest
import json
import re
import subprocess
import sys
from pathlib import Path

import drjit
import numpy as np
import pytest

import radiosity as rd

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PAGES = sorted([*DOCS.rglob("*.md"), *ROOT.glob("*.md")])
TABLES = ("BASELINES", "PRESETS")  # dictionaries, which have no docstring of their own: their examples are in docs/api.md
FENCE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def blocks(page: Path) -> list[str]:
    """The Python of a page, each block at the line where it stands, so that a failure names it."""
    text = page.read_text(encoding="utf-8")
    return ["\n" * text.count("\n", 0, found.start(1)) + found[1] for found in FENCE.finditer(text)]


def test_the_tutorial_runs():
    """In order, in one namespace, with its assertions."""
    names: dict = {"__name__": "tutorial"}
    page = DOCS / "tutorial.md"
    found = blocks(page)
    assert sum(block.count("assert ") for block in found) > 20
    threads = drjit.thread_count()
    try:
        for block in found:
            exec(compile(block, str(page), "exec"), names)
    finally:
        drjit.set_thread_count(threads)


def test_the_office_is_measured_as_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {"__name__": "lighting"}
    for block in blocks(DOCS / "lighting.md"):
        exec(compile(block, "lighting.md", "exec"), names)
    assert (tmp_path / "office.png").exists()


def test_two_solutions_are_compared_as_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (block,) = blocks(DOCS / "compare.md")
    exec(compile(block, "compare.md", "exec"), {"__name__": "compare"})
    assert (tmp_path / "difference.png").exists()


def test_a_report_is_made_as_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (block,) = blocks(DOCS / "reports.md")
    exec(compile(block, "reports.md", "exec"), {"__name__": "reports"})
    assert (tmp_path / "room.html").stat().st_size > 100_000


def test_parts_of_a_run_are_merged_as_the_page_shows(tmp_path, monkeypatch):
    """To the bits of one run."""
    monkeypatch.chdir(tmp_path)
    names: dict = {"__name__": "parts"}
    (block,) = blocks(DOCS / "long-runs.md")
    exec(compile(block, "long-runs.md", "exec"), names)
    whole = rd.solve(names["solution"].patches, quanta=2**18, replicates=8)
    assert np.array_equal(names["solution"].irradiance_standard_error, whole.irradiance_standard_error)


def test_a_line_set_is_solved_as_the_page_shows(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {"__name__": "lines"}
    (block,) = blocks(DOCS / "line-sets.md")
    exec(compile(block, "line-sets.md", "exec"), names)
    assert names["dim"].radiosity == pytest.approx(names["day"].radiosity / 8, rel=1e-9)
    assert names["warm"].bands == ("red", "green", "blue")
    assert rd.load_lines("room.npz").rays == names["lines"].rays


@pytest.mark.parametrize("name", [name for name in rd.__all__ if name not in TABLES])
def test_examples_of_public_names(name, tmp_path, monkeypatch):
    """Each public name has an example in its docstring, and it shows what it says."""
    monkeypatch.chdir(tmp_path)
    (example,) = doctest.DocTestFinder(recurse=False).find(getattr(rd, name), name, globs={"rd": rd})
    check(example)


def test_examples_of_the_reference():
    page = DOCS / "api.md"
    example = doctest.DocTestParser().get_doctest(page.read_text(encoding="utf-8"), {"rd": rd}, "api", str(page), 0)
    assert all(f"rd.{table}" in example.docstring for table in TABLES)
    check(example)


def check(example: doctest.DocTest) -> None:
    """There is an example, and it shows what it says."""
    assert example.examples, f"{example.name} has no example in its docstring"
    told: list[str] = []
    failed, _ = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(example, out=told.append)
    assert not failed, "".join(told)


def anchors(page: Path) -> set[str]:
    """Names of headings, as a forge and the site make them."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    heads = re.findall(r"^#+ +(.+?)\s*$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def links(page: Path) -> list[str]:
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    return [link for link in re.findall(r"\]\(([^)\s]+)\)", text) if not link.startswith(("http:", "https:", "mailto:"))]


def test_every_link_leads_somewhere():
    wrong = []
    for page in PAGES:
        for link in links(page):
            path, _, anchor = link.partition("#")
            target = (page.parent / path).resolve() if path else page
            if not target.exists() or (anchor and anchor not in anchors(target)):
                wrong.append(f"{page.relative_to(ROOT)}: {link}")
    assert not wrong
    assert sum(len(links(page)) for page in PAGES) > 100


def test_every_page_is_in_the_contents():
    """A page that no table of contents names is not found on the site."""
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    listed = {
        line.strip()
        for block in re.findall(r"^```\{toctree\}\n(.*?)^```$", index, re.MULTILINE | re.DOTALL)
        for line in block.splitlines()
        if line.strip() and not line.startswith(":")
    }
    pages = {page.relative_to(DOCS).with_suffix("").as_posix() for page in PAGES if page.is_relative_to(DOCS)} - {"index"}
    assert listed == pages


def test_the_reference_names_everything_public():
    text = (DOCS / "api.md").read_text(encoding="utf-8")
    documented = re.findall(r"^\.\. (?:auto\w+|py:data):: radiosity\.(\w+)$", text, re.MULTILINE)
    assert sorted(documented) == sorted(rd.__all__)


def test_the_page_of_promises_names_the_arrays_of_a_file(tmp_path):
    """Every key of a solution's file, and no other; those of the run and of textures are no promise."""
    rd.solve(rd.subdivide(rd.load_scene("cornell-box"), cells=1), "random-walk", rays=10_000).save(tmp_path / "box.npz")
    with np.load(tmp_path / "box.npz") as file:
        kept = {key for key in file.files if not key.startswith(("state_", "reflectance_paint_", "emission_paint_"))}
        assert json.loads(str(file["meta"])).keys() == promised("meta")
    rows = re.findall(r"^\| (`[^|]*`) \| [^|]+ \|", (DOCS / "stability.md").read_text(encoding="utf-8"), re.MULTILINE)
    listed = {name for row in rows for name in re.findall(r"`(\w+)`", row)}
    assert kept == listed


def promised(key: str) -> set[str]:
    """Names in the last column of a key's row."""
    (row,) = re.findall(rf"^\| `{key}` \|.*\| ([^|]*) \|$", (DOCS / "stability.md").read_text(encoding="utf-8"), re.MULTILINE)
    return set(re.findall(r"`(\w+)`", row))


def test_the_version_stands_once():
    """The package's own word, the metadata and the citation agree."""
    assert f"\nversion: {rd.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f'\nversion = "{rd.__version__}"\n' in (ROOT / "pyproject.toml").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_site_builds_without_a_warning(tmp_path):
    """As `make docs` does; and links to files beside docs/ lead to pages of the site."""
    for package in ("sphinx", "myst_parser", "furo"):
        pytest.importorskip(package, reason="the site is built by what `make docs` installs")
    strict = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "--nitpicky", "-q", "-b", "html"]
    places = ["-d", str(tmp_path / "trees"), str(DOCS), str(tmp_path / "site")]
    done = subprocess.run([*strict, *places], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    index = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    for page in ("start", "changelog", "contributing", "reporting", "conduct", "report"):
        assert (tmp_path / "site" / f"{page}.html").exists()
        assert page == "report" or f'href="{page}.html"' in index


def test_every_scene_format_is_told():
    """Where a user looks for it: the docstring of `load_scene`, and the help of the command line."""
    from radiosity.cli import solve
    from radiosity.scene.formats import FORMATS

    for text in (rd.load_scene.__doc__, solve.solve.__doc__):
        assert [suffix for suffix in FORMATS if not re.search(rf"{re.escape(suffix)}\b", str(text))] == []
