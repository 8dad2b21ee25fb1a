"""What a solution tells of the program that made it."""

from importlib.metadata import PackageNotFoundError

import radiosity as rd
from radiosity.run import record


def test_a_source_tree_that_is_not_installed_loses_nothing(monkeypatch):
    """Versions are read when all is computed."""

    def missing(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr(record, "version", missing)
    monkeypatch.setattr(record, "_version", record._version.__wrapped__)
    solution = rd.solve(rd.subdivide(rd.load_scene("labyrinth-0.5"), cells=1), "random-walk", rays=20_000)
    assert set(solution.provenance["versions"].values()) == {"unknown"}
