"""Curved primitives of MGF become closed surfaces that face as the specification says."""

import numpy as np
import pytest

import radiosity as rd

pytest.importorskip("pyradiance")

GREY = "m grey =\n c\n rd 0.5\n"


def volume(scene):
    """Enclosed by faces that point outwards, by the divergence theorem."""
    origin, one, two = scene.frames
    centre = origin + np.where(scene.is_quad[:, None], (one + two) / 2, (one + two) / 3)
    return float((np.einsum("ij,ij->i", centre, scene.normal) * scene.area).sum() / 3)


@pytest.mark.parametrize(
    ("text", "area", "enclosed"),
    [
        ("sph o 1", 4 * np.pi, 4 / 3 * np.pi),
        ("sph o -1", 4 * np.pi, -4 / 3 * np.pi),
        ("cyl o 0.5 top\nring top 0 0.5\nring under 0 0.5", np.pi * 3 + np.pi / 2, 3 * np.pi / 4),
        ("cone o 1 top 0\nring under 0 1", np.pi * np.sqrt(10) + np.pi, np.pi),
        ("cone top 0 o 1\nring under 0 1", np.pi * np.sqrt(10) + np.pi, np.pi),
        ("torus under 1 3", 4 * np.pi**2 * 2, 2 * np.pi**2 * 2),
        ("torus under -1 -3", 4 * np.pi**2 * 2, -2 * np.pi**2 * 2),
        ("prism x y z 2", 1 + np.sqrt(2) * 2 + 4, 1.0),
        ("prism x y z -2", 1 + np.sqrt(2) * 2 + 4, -1.0),
        ("xf -mx\nsph o 1\nxf", 4 * np.pi, 4 / 3 * np.pi),
    ],
)
def test_curved_primitives_face_outwards(tmp_path, text, area, enclosed):
    points = "v o =\n p 0 0 0\nv top =\n p 0 0 3\n n 0 0 1\nv under =\n p 0 0 0\n n 0 0 -1\n"
    file = tmp_path / "scene.mgf"
    file.write_text(points + "v x =\n p 0 0 0\nv y =\n p 1 0 0\nv z =\n p 0 1 0\n" + GREY + text + "\n")
    scene = rd.load_scene(file)
    assert scene.area.sum() == pytest.approx(area, rel=0.03)
    assert volume(scene) == pytest.approx(enclosed, rel=0.05)
