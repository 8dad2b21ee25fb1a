"""Mitsuba scenes with random features."""

from pathlib import Path

import numpy as np
from mitsuba_rays import obj_bytes, ply_bytes, serialized_bytes

from .draw import Draw, Sample, Shape
from .mitsuba_material import bsdf, emitter, no_bsdf

HABITS = {
    "mirror": 0.3,
    "uneven scale": 0.4,
    "meshes": 0.5,
    "round shapes": 0.3,
    "instances": 0.25,
    "twosided": 0.5,
    "textures": 0.35,
    "flipped normals": 0.15,
    "face normals": 0.2,
    "shared BSDFs": 0.4,
    "parameters": 0.2,
    "includes": 0.15,
    "other emitters": 0.15,
    "sensors": 0.2,
    "look-at": 0.2,
    "emission": 0.5,
    "plastics": 0.2,
    "conductors": 0.1,
    "spectra": 0.2,
    "constant spectra": 0.15,
    "colours": 0.6,
}  # chance that a file has any of it
MESHES = {"obj": obj_bytes, "ply": ply_bytes, "serialized": serialized_bytes}


def write(folder: Path, seed: int) -> Sample:
    draw = Draw("xml", seed)
    for feature, chance in HABITS.items():
        draw.has(feature, chance)
    lines = ['<scene version="3.0.0">']
    if "parameters" in draw.features:
        lines += ['<default name="size" value="0.7"/>', '<default name="tint" value="0.4"/>']
    names = []
    if "shared BSDFs" in draw.features:
        names = ["red", "blue"]
        shared = [bsdf(draw, folder, f"{seed}_{name}", f' id="{name}"', textured=False) for name in names]
        if "includes" in draw.features:
            (folder / f"{seed}_part.xml").write_text('<scene version="3.0.0">' + "\n".join(shared) + "</scene>")
            lines.append(f'<include filename="{seed}_part.xml"/>')
        else:
            lines += shared
    count = int(draw.integers(1, 5))
    for number in range(count):
        lines += _shape(draw, folder, seed, f"thing{number}", names, grouped=False)
    if "instances" in draw.features:
        lines.append('<shape type="shapegroup" id="crowd">')
        lines += _shape(draw, folder, seed, "member", names, grouped=True)
        lines.append("</shape>")
        for number in range(int(draw.integers(1, 4))):
            move = _transform(draw, even=False)
            lines.append(f'<shape type="instance" id="copy{number}"><ref id="crowd"/>{move}</shape>')
    if "other emitters" in draw.features:
        lines.append('<emitter type="point"><point name="position" x="0" y="5" z="0"/></emitter>')
    if "sensors" in draw.features:
        lines.append(
            '<sensor type="perspective"><float name="fov" value="45"/><transform name="to_world">'
            '<lookat origin="0,0,9" target="0,0,0" up="0,1,0"/></transform></sensor>'
        )
    lines.append("</scene>")
    path = folder / f"{seed}.xml"
    path.write_text("\n".join(lines) + "\n")
    return Sample(path, "mitsuba", draw.features)


def _shape(draw: Draw, folder: Path, seed: int, name: str, names: list[str], *, grouped: bool) -> list[str]:
    kinds = ["rectangle", "cube", *(MESHES if "meshes" in draw.features else ())]
    if "round shapes" in draw.features and not grouped:
        kinds += ["sphere", "disk", "cylinder"]
    kind = draw.one(*kinds)
    inside = [_transform(draw, even=kind in ("sphere", "cylinder"))]
    if kind in MESHES:
        shape = draw.shape()
        file = f"{seed}_{name}.{kind}"
        (folder / file).write_bytes(_mesh(draw, kind, shape))
        inside.append(f'<string name="filename" value="{file}"/>')
        if "face normals" in draw.features and draw.random() < 0.5:
            inside.append('<boolean name="face_normals" value="true"/>')
    if kind == "sphere":
        inside.append('<float name="radius" value="0.6"/><point name="center" x="0.2" y="0.1" z="-0.3"/>')
    if kind == "cylinder":
        inside.append('<point name="p0" x="0" y="0.1" z="0"/><point name="p1" x="0.3" y="1" z="0.5"/>')
    if "flipped normals" in draw.features and draw.random() < 0.5:
        inside.append('<boolean name="flip_normals" value="true"/>')
    textured = kind not in MESHES  # these meshes have no texture coordinates
    shining = not grouped and "emission" in draw.features and draw.random() < 0.4
    if names and draw.random() < 0.7:
        inside.append(f'<ref id="{draw.one(*names)}"/>')
    elif "colours" in draw.features and kind == "ply" and draw.has("mesh attributes", 0.7):
        file = f"{seed}_{name}.ply"
        (folder / file).write_bytes(_painted(draw, (folder / file).read_bytes()))
        inside.append(
            '<bsdf type="diffuse"><texture type="mesh_attribute" name="reflectance">'
            '<string name="name" value="vertex_color"/></texture></bsdf>'
        )
    elif draw.random() < 0.85:
        inside.append(bsdf(draw, folder, f"{seed}_{name}", "", textured=textured))
    elif shining:
        inside.append(no_bsdf(draw))
    else:
        draw.features.add("no BSDF")
    if shining:
        inside.append(emitter(draw, folder, f"{seed}_{name}", textured=textured))
    return [f'<shape type="{kind}" id="{name}">', *inside, "</shape>"]


def _mesh(draw: Draw, kind: str, shape: Shape) -> bytes:
    triangles = shape.triangles()
    corners = shape.points[triangles.ravel()]
    normals = np.cross(corners[1::3] - corners[::3], corners[2::3] - corners[::3])
    normals = np.repeat(normals / np.linalg.norm(normals, axis=1, keepdims=True), 3, axis=0)
    given = normals if draw.has("normals", 0.5) else None
    return MESHES[kind](corners, given, np.arange(len(corners)).reshape(-1, 3))


def _painted(draw: Draw, data: bytes) -> bytes:
    """An ASCII PLY file with a colour for each vertex."""
    head, body = data.decode().split("end_header\n")
    head = head.replace("element face", "property float r\nproperty float g\nproperty float b\nelement face")
    count = int(head.split("element vertex ")[1].split()[0])
    rows = body.splitlines()
    rows[:count] = [f"{row} " + " ".join(f"{v:.4f}" for v in draw.uniform(0.05, 0.9, 3)) for row in rows[:count]]
    return (head + "end_header\n" + "\n".join(rows) + "\n").encode()


def _transform(draw: Draw, *, even: bool) -> str:
    """A to_world of one to four steps; ``even``: no uneven scale, and no mirror."""
    scale = np.full(3, draw.uniform(0.5, 1.5))
    if not even and "uneven scale" in draw.features:
        scale = draw.uniform(0.4, 2.0, 3)
    if not even and "mirror" in draw.features and draw.random() < 0.5:
        scale[int(draw.integers(3))] *= -1
    axis, move = draw.normal(size=3), draw.uniform(-3, 3, 3)
    axis /= np.linalg.norm(axis)  # of another length Mitsuba makes no rotation, and normals that do not fit
    steps = ['<scale x="{:.4f}" y="{:.4f}" z="{:.4f}"/>'.format(*scale)]
    if "parameters" in draw.features:
        steps.append('<scale value="$size"/>')
    steps.append('<rotate x="{:.9f}" y="{:.9f}" z="{:.9f}" angle="{:.3f}"/>'.format(*axis, draw.uniform(0, 360)))
    if "look-at" in draw.features and draw.random() < 0.5:
        target = ", ".join(f"{v:.3f}" for v in draw.uniform(-5, 5, 3))
        steps.append(f'<lookat origin="1, 2, 0.5" target="{target}" up="0.1, 0.2, 1"/>')
    if not even and draw.has("matrices", 0.2):
        shear = np.eye(4)
        shear[:3, :3] += draw.uniform(-0.2, 0.2, (3, 3))
        steps.append(f'<matrix value="{" ".join(f"{v:.5f}" for v in shear.ravel())}"/>')
    steps.append('<translate x="{:.4f}" y="{:.4f}" z="{:.4f}"/>'.format(*move))
    return f'<transform name="to_world">{"".join(steps)}</transform>'
