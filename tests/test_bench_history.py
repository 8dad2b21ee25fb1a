"""`make bench` keeps its figures, and `make bench-compare` prints the ratios of the last two runs."""

import json

import pytest

from benchmarks import history


def test_runs_are_appended_and_the_last_two_compared(tmp_path):
    file = tmp_path / "history.jsonl"
    for rate, also in ((7.0, {}), (10.0, {"old": 1.0}), (12.0, {"new": 3.0})):
        history.note("room, 68 faces", rate, "M/s")
        for name, value in also.items():
            history.note(name, value, "s")
        history.keep(file)
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    assert [line["figures"]["room, 68 faces, M/s"] for line in lines] == [7, 10, 12]
    assert "old, s" not in lines[2]["figures"]  # each run has its own
    assert lines[0]["machine"]["radiosity"]
    table = [line.split() for line in history.compare(file).splitlines()]
    assert ["room,", "68", "faces,", "M/s", "10.00", "12.00", "1.20"] in table
    assert ["new,", "s", "new", "3.00", "?"] in table
    assert ["old,", "s", "1.00", "gone"] in table


def test_another_machine_is_told(tmp_path, monkeypatch):
    file = tmp_path / "history.jsonl"
    here = history.machine()
    for count in (2, 16):
        monkeypatch.setattr(history, "machine", lambda count=count: here | {"processors": count})
        history.note("start-up", 1.0, "s")
        history.keep(file)
    assert "not alike: processors was 2, is 16" in history.compare(file)
    assert history.compare(file).count("not alike") == 1


@pytest.mark.parametrize("runs", [0, 1])
def test_one_run_is_not_compared(tmp_path, runs):
    file = tmp_path / "history.jsonl"
    for _ in range(runs):
        history.keep(file)
    with pytest.raises(SystemExit, match=rf"holds {runs} run"):
        history.compare(file)
