"""MGF descriptions with random features."""

from pathlib import Path

import numpy as np

from .draw import Draw, Sample, Shape, star

HABITS = {
    "mirror": 0.3,
    "arrays": 0.35,
    "nested transformations": 0.35,
    "nested objects": 0.4,
    "curved primitives": 0.2,
    "prisms": 0.25,
    "holes": 0.2,
    "includes": 0.25,
    "templates": 0.35,
    "one-sided": 0.35,
    "colours": 0.6,
    "specular": 0.3,
    "emission": 0.5,
    "line continuation": 0.15,
    "colour temperatures": 0.15,
    "mixed colours": 0.15,
    "spectra": 0.1,
    "normals": 0.25,
    "iterations": 0.15,
    "comments": 0.3,
}  # chance that a file has any of it


def write(folder: Path, seed: int) -> Sample:
    draw = Draw("mgf", seed)
    for feature, chance in HABITS.items():
        draw.has(feature, chance)
    lines = ["# made at random"] if "comments" in draw.features else []
    lines += _colors(draw)
    names = [f"m{number}" for number in range(int(draw.integers(1, 4)))]
    if "one-sided" in draw.features:
        names.append("single")
    for number, name in enumerate(names):
        lines += _material(draw, name, names[0] if number and "templates" in draw.features else "")
    for number in range(int(draw.integers(1, 4))):
        lines += _object(draw, number, names)
    if "curved primitives" in draw.features:
        lines += ["o round", f"m {names[0]}", *_curved(draw), "o"]
    if "includes" in draw.features:
        (folder / f"{seed}_part.mgf").write_text("\n".join(_object(draw, 9, names)) + "\n")
        for _ in range(int(draw.integers(1, 3))):
            lines.append(f"i {seed}_part.mgf {_transform(draw)}")
    path = folder / f"{seed}.mgf"
    path.write_text("\n".join(lines) + "\n")
    return Sample(path, "mgf", draw.features)


def _colors(draw: Draw) -> list[str]:
    lines = []
    for number in range(3):
        lines.append(f"c tint{number} =")
        if "colours" in draw.features:
            lines.append("\tcxy {:.4f} {:.4f}".format(*draw.uniform((0.27, 0.29), (0.42, 0.39))))
    if "colour temperatures" in draw.features:
        lines += ["c tint1 =", f"\tcct {draw.uniform(3000, 7000):.0f}"]
    if "spectra" in draw.features:
        lines += ["c tint0 =", "\tcspec 400 700 " + " ".join(f"{v:.3f}" for v in draw.uniform(0.4, 1, 7))]
    if "mixed colours" in draw.features:
        lines += ["c tint2 =", "\tcmix {:.3f} tint0 {:.3f} tint1".format(*draw.uniform(0.2, 1, 2))]
    if "mixed colours" in draw.features and draw.features & {"spectra", "colour temperatures"}:
        draw.features.add("mixed spectra")
    return lines


def _material(draw: Draw, name: str, template: str) -> list[str]:
    lines = [f"m {name} = {template}".rstrip(), f"\tc tint{int(draw.integers(3))}", f"\trd {draw.uniform(0.05, 0.35):.4f}"]
    if "specular" in draw.features and draw.random() < 0.5:
        lines += ["\tc", f"\trs {draw.uniform(0.02, 0.2):.3f} 0.1"]
    if "emission" in draw.features and draw.random() < 0.4:
        lines += [f"\tc tint{int(draw.integers(3))}", f"\ted {draw.uniform(10, 1000):.2f}"]
    lines.append("\tsides 1" if name == "single" else "\tsides 2")
    return lines


def _object(draw: Draw, number: int, names: list[str]) -> list[str]:
    lines = [f"o thing{number}"]
    nested = "nested objects" in draw.features and draw.random() < 0.6
    if nested:
        lines.append("o inner")
    moves = [_transform(draw) for _ in range(2 if "nested transformations" in draw.features else 1)]
    lines += [f"xf {move}" for move in moves]
    for part in range(int(draw.integers(1, 3))):
        lines.append(f"m {draw.one(*names)}")
        lines += _faces(draw, f"{number}{part}", draw.shape())
    if "prisms" in draw.features:
        lines += _vertices(draw, "q", np.array([(0, 0, 0), (1, 0, 0), (1.2, 0.8, 0), (0.3, 1, 0)]))
        lines.append(f"prism q0 q1 q2 q3 {draw.uniform(0.3, 1.5):.3f}")
    if "holes" in draw.features:
        outline, hole = star(draw).points * 3, np.array([(-0.2, -0.2, 0), (-0.2, 0.2, 0), (0.2, 0.2, 0), (0.2, -0.2, 0)])
        lines += _vertices(draw, "h", np.vstack([outline, hole]))
        first, second = ([f"h{i}" for i in r] for r in (range(len(outline)), range(len(outline), len(outline) + 4)))
        lines.append(f"fh {' '.join(first)} - {' '.join(second)}")
    return [*lines, *["xf"] * len(moves), *(["o"] if nested else []), "o"]


def _faces(draw: Draw, label: str, shape: Shape) -> list[str]:
    lines = _vertices(draw, f"v{label}_", shape.points)
    for polygon in shape.polygons:
        line = "f " + " ".join(f"v{label}_{corner}" for corner in polygon)
        lines.append(line.replace(" ", " \\\n ", 1) if "line continuation" in draw.features else line)
    return lines


def _vertices(draw: Draw, stem: str, points: np.ndarray) -> list[str]:
    lines = []
    for number, point in enumerate(points):
        lines += [f"v {stem}{number} =", "\tp {:.6f} {:.6f} {:.6f}".format(*point)]
        if "normals" in draw.features and draw.random() < 0.3:
            lines.append("\tn 0 0 0")  # no normal: the face's own
    return lines


def _curved(draw: Draw) -> list[str]:
    lines = _vertices(draw, "r", np.array([(0, 0, 0), (0.2, 0.3, 1.4)]))
    lines += ["v rn =", "\tp 3 0 0", "\tn 0.3 0.2 1"]
    kinds = ["sph r0 0.5", "cyl r0 0.3 r1", "cone r0 0.4 r1 0.1", "ring rn 0.1 0.6", "ring rn 0 0.4", "torus rn 0.2 0.5"]
    return lines + [str(draw.one(*kinds)) for _ in range(2)]


def _transform(draw: Draw) -> str:
    words = []
    if draw.random() < 0.5:
        words.append(f"-s {draw.uniform(0.5, 1.5):.4f}")
    if "mirror" in draw.features and draw.random() < 0.5:
        words.append(draw.one("-mx", "-my", "-mz"))
    words += [f"{draw.one('-rx', '-ry', '-rz')} {draw.uniform(-180, 180):.3f}" for _ in range(int(draw.integers(0, 3)))]
    words.append("-t {:.4f} {:.4f} {:.4f}".format(*draw.uniform(-3, 3, 3)))
    if "iterations" in draw.features and draw.random() < 0.5:
        words.append(f"-i {int(draw.integers(0, 4))} -rz 20 -t 0.5 0 0 -i 1")
    if "arrays" in draw.features and draw.random() < 0.5:
        words.append(f"-a {int(draw.integers(1, 4))} -t 0 0 {draw.uniform(2, 5):.3f}")
        if draw.random() < 0.3:
            words.append("-a 2 -rz 90 -t 4 0 0")
    return " ".join(words)
