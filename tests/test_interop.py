"""Our readers beside other programs' readers, on files made at random (docs/interop.md).

``-m slow`` reads 240 files of each format with every other program that is here. Blender is one where ``bpy`` can be imported, or
where RADIOSITY_BPY_PYTHON names a Python that has it.
"""

from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from interop import by_mitsuba
from interop.compare import differences
from interop.explained import EXPLAINED, VERSIONS
from interop.readers import FORMATS
from interop.record import surface
from interop.run import run
from interop.table import rows

QUICK, LONG = 8, 240  # files
PAIRS = [(name, reader) for name, form in FORMATS.items() for reader in form.readers]
SLOW_TO_START = ("blender",)


def compared(folder, name, reader, count):
    """The outcome over the first files of a format; the test is skipped where the other program is not here."""
    other = FORMATS[name].readers[reader]
    if reason := other.missing():
        pytest.skip(reason)
    return run(folder, FORMATS[name].write, range(count), reader, other)


@pytest.mark.parametrize(("name", "reader"), [pair for pair in PAIRS if pair[1] not in SLOW_TO_START])
def test_a_few_files(tmp_path, name, reader):
    outcome = compared(tmp_path, name, reader, QUICK)
    assert not outcome.faults, "\n".join(outcome.faults)
    assert outcome.alike >= 1


@pytest.mark.slow
@pytest.mark.parametrize(("name", "reader"), PAIRS)
def test_many_files(tmp_path, monkeypatch, name, reader):
    """All differences are explained, and all explanations are needed: one that no file needs any more is out of date."""
    monkeypatch.setattr(by_mitsuba, "POINTS", 5000)
    outcome = compared(tmp_path, name, reader, LONG)
    print(
        f"{name}, {reader}: {outcome.files} files, {outcome.alike} alike, "
        + ", ".join(f"{why.feature} {count}" for why, count in outcome.used.items())
    )
    assert not outcome.faults, "\n".join(outcome.faults)
    known = {why for why in EXPLAINED if (why.format, why.reader) == (name, reader) and why.feature in outcome.features}
    assert not known - set(outcome.used), "explained, but seen in no file"
    assert outcome.alike >= outcome.files / 4


def test_the_page_shows_every_explained_difference():
    page = (Path(__file__).resolve().parents[1] / "docs" / "interop.md").read_text()
    missing = [row for name in FORMATS for row in rows(name) if row not in page]
    assert not missing, f"python tests/interop/table.py prints the tables\n{missing}"
    assert not [version for version in VERSIONS.values() if version not in page]


SQUARE = np.array([[(0, 0, 0), (1, 0, 0), (1, 1, 0)], [(0, 0, 0), (1, 1, 0), (0, 1, 0)]], float)


@pytest.mark.parametrize(
    ("change", "quantities"),
    [
        ({}, []),
        ({"reflectance": np.full(3, 0.501)}, ["reflectance"]),
        ({"power": np.array([3.0, 3.0, 3.01])}, ["power"]),
        ({"sides": 2}, ["sides"]),
        ({"area": 1.001}, ["area"]),
        ({"vector": -np.array([0.0, 0.0, 1.0])}, ["vector"]),
        ({"bounds": np.array([(0.0, 0, 0), (1, 1, 0.001)])}, ["bounds"]),
    ],
)
def test_differences_are_seen(change, quantities):
    one = surface(SQUARE, reflectance=[0.5] * 3, exitance=[3.0] * 3, sides=1)
    assert [found.quantity for found in differences({"a": one}, {"a": replace(one, **change)})] == quantities


def test_missing_surfaces_are_seen():
    one = surface(SQUARE)
    assert [found.quantity for found in differences({"a": one, "b": one}, {"a": one})] == ["names"]


def change_parts(monkeypatch, module, change):
    """Change the parts that a reader hands over."""
    assemble = import_module(module).assemble
    monkeypatch.setattr(f"{module}.assemble", lambda parts, *rest, **more: assemble(change(parts), *rest, **more))


def inside_out(monkeypatch):
    """Every second part of a glTF file is wound the other way round."""

    def turned(parts):
        return [replace(part, faces=np.asarray(part.faces)[:, ::-1]) if i % 2 else part for i, part in enumerate(parts)]

    change_parts(monkeypatch, "radiosity.scene.formats.gltf", turned)


def colors_not_decoded(monkeypatch):
    """Colours of PLY vertices are taken as linear."""
    import radiosity.scene.formats.mesh.ply_colors as mesh

    monkeypatch.setattr(mesh, "decode_srgb", lambda values: values)


def instances_scaled_twice(monkeypatch):
    """A shape of an instance group is moved by its own transformation twice."""
    import radiosity.scene.formats.mitsuba as mitsuba

    placed = mitsuba.placed
    monkeypatch.setattr(mitsuba, "placed", lambda geometry, inner, outer, **more: placed(geometry, inner, outer @ outer, **more))


def decoded_twice(monkeypatch):
    """Kd of MTL files is taken as sRGB."""

    def darker(parts):
        return [replace(part, material=replace(part.material, reflectance=squared(part.material.reflectance))) for part in parts]

    def squared(values):
        return values and tuple(v**2 for v in values)

    change_parts(monkeypatch, "radiosity.scene.formats.obj", darker)


def arrays_without_their_last(monkeypatch):
    """Arrays of MGF have one instance less."""
    import radiosity.scene.formats.mgf.faces as faces

    instances = faces.instances
    monkeypatch.setattr(faces, "instances", lambda words: iter(list(instances(words))[:-1] or list(instances(words))))


@pytest.mark.parametrize(
    ("name", "reader", "wrong", "files"),
    [
        ("gltf", "trimesh", inside_out, 12),
        ("ply", "trimesh", colors_not_decoded, 12),
        ("mitsuba", "mitsuba", instances_scaled_twice, 12),
        ("obj", "trimesh", decoded_twice, 12),
        ("mgf", "radiance", arrays_without_their_last, 12),
    ],
)
def test_wrong_readers_are_rejected(tmp_path, monkeypatch, name, reader, wrong, files):
    wrong(monkeypatch)
    assert compared(tmp_path, name, reader, files).faults
