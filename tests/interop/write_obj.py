"""OBJ files with MTL libraries and textures, with random features."""

from dataclasses import dataclass, field
from pathlib import Path

from .draw import Draw, Sample, Shape, star
from .images import save_png

HABITS = {
    "relative indices": 0.2,
    "line continuation": 0.1,
    "comments after a face": 0.1,
    "lines and points": 0.2,
    "smoothing": 0.3,
    "fourth coordinate": 0.1,
    "normals": 0.4,
    "coordinates": 0.4,
    "materials within an object": 0.4,
}  # chance that a file has any of it


@dataclass
class Text:
    """The lines of a file so far, and how many vertices they hold."""

    lines: list[str] = field(default_factory=list)
    points: int = 0
    coordinates: int = 0


def write(folder: Path, seed: int) -> Sample:
    draw = Draw("obj", seed)
    for feature, chance in HABITS.items():
        draw.has(feature, chance)
    text = Text(["# written at random"])
    materials = [draw.one(f"mat{i}", f"mat.{i}", f"Mat-{i}", f"mat of {i}") for i in range(int(draw.integers(1, 4)))]
    library = draw.one(f"{seed}.mtl", f"of {seed}.mtl") if draw.has("library name with a blank", 0.15) else f"{seed}.mtl"
    if draw.has("no library", 0.1):
        materials = []
    else:
        text.lines.append(f"mtllib {library}")
        (folder / library).write_text("\n".join(_library(draw, folder, seed, materials)) + "\n")
    painted = not materials and draw.has("vertex colours", 0.7)
    shapes = [draw.shape().moved(draw.matrix()) for _ in range(int(draw.integers(1, 4)))]
    if draw.has("concave polygon", 0.1):
        shapes.append(star(draw).moved(draw.matrix()))
    for number, shape in enumerate(shapes):
        if draw.random() < 0.5:
            shape = Shape(shape.points, shape.triangles().tolist(), shape.uv)
        sizes = {len(p) for p in shape.polygons}
        draw.features |= {"polygons"} if max(sizes) > 3 else set()
        draw.features |= {"more than four corners"} if max(sizes) > 4 else set()
        _object(draw, text, number, shape, materials, painted)
    if "vertex colours" in draw.features and "polygons" in draw.features:
        draw.features.add("coloured polygons")
    path = folder / f"{seed}.obj"
    end = "\r\n" if draw.has("crlf", 0.2) else "\n"
    path.write_bytes((end.join(text.lines) + end).encode())
    return Sample(path, "obj", draw.features)


def _object(draw: Draw, text: Text, number: int, shape: Shape, materials: list[str], painted: bool) -> None:
    named = draw.one("o", "g", "both")
    if named != "g":
        text.lines.append(f"o thing{number}")
    if named != "o":
        text.lines.append(f"g part{number}")
        draw.features.add("groups")
    if "smoothing" in draw.features:
        text.lines.append(draw.one("s 1", "s off"))
    first, first_uv = text.points, text.coordinates
    with_uv = bool(draw.features & {"textures", "emission textures", "coordinates"})
    with_normals = "normals" in draw.features
    for row in shape.points:
        colors = [f"{v:.4f}" for v in draw.uniform(0.1, 0.9, 3)] if painted else []
        colors = ["1.0"] if "fourth coordinate" in draw.features and not painted else colors
        text.lines.append(" ".join(["v", *(repr(float(v)) for v in row), *colors]))
    text.points += len(shape.points)
    if with_uv:
        third = " 0" if draw.has("third texture coordinate", 0.2) else ""
        text.lines += [f"vt {u:.5f} {v:.5f}{third}" for u, v in shape.uv]
        text.coordinates += len(shape.uv)
    if with_normals:
        text.lines += ["vn 0 0 1"]
    relative = "relative indices" in draw.features
    if materials:
        text.lines.append(f"usemtl {draw.one(*materials)}")
    for polygon in shape.polygons:
        if materials and "materials within an object" in draw.features and draw.random() < 0.3:
            text.lines.append(f"usemtl {draw.one(*materials)}")
        corners = []
        for corner in polygon:
            point, uv = first + corner, first_uv + corner
            point, uv = (point - text.points, uv - text.coordinates) if relative else (point + 1, uv + 1)
            normal = "-1" if relative else "1"
            corners.append(
                f"{point}/{uv}/{normal}"
                if with_uv and with_normals
                else f"{point}/{uv}"
                if with_uv
                else f"{point}//{normal}"
                if with_normals
                else f"{point}"
            )
        line = "f " + " ".join(corners)
        if "line continuation" in draw.features and draw.random() < 0.5:
            head, tail = line.rsplit(" ", 1)
            text.lines.append(head + " \\")
            line = tail
        text.lines.append(line + (" # a face" if "comments after a face" in draw.features else ""))
    if "lines and points" in draw.features:
        text.lines += [f"l {first + 1} {first + 2}", f"p {first + 1}"]


def _library(draw: Draw, folder: Path, seed: int, materials: list[str]) -> list[str]:
    lines = ["# materials"]
    for number, name in enumerate(materials):
        lines += [f"newmtl {name}", "Ka 0 0 0"]
        textured = draw.has("textures", 0.3)
        tinted = not textured or draw.has("Kd beside a texture", 0.4)
        lines.append("\tKd " + " ".join(f"{v}" for v in (draw.color() if tinted else [1.0] * 3)))
        if draw.has("habits of programs", 0.3):
            lines += ["Tf 1 1 1", "Ni 1.45", "sharpness 60", "map_Bump -bm 0.2 nothing.png"][: int(draw.integers(1, 4))]
        if draw.has("specular", 0.3):
            lines += ["Ks 0.3 0.3 0.3", "Ns 50", "illum 2"]
        if draw.has("transparency", 0.1):
            lines.append(draw.one("d 0.5", "Tr 0.25"))
        if textured:
            lines.append(f"map_Kd {_options(draw)}{_image(draw, folder, f'{seed}_{number}.png')}")
        if draw.has("emission", 0.4):
            shining = draw.has("emission textures", 0.3)
            tinted = not shining or draw.has("Ke beside a texture", 0.4)
            lines.append("Ke " + " ".join(f"{v:.3f}" for v in (draw.uniform(0, 5, 3) if tinted else [1.0] * 3)))
            if shining:
                lines.append(f"map_Ke {_image(draw, folder, f'{seed}_{number}e.png')}")
    return lines


def _options(draw: Draw) -> str:
    text = "-clamp on " if draw.has("texture clamp", 0.2) else ""
    if draw.has("texture scale", 0.3):
        text += "-s {:.3f} {:.3f} 1 ".format(*draw.uniform(0.5, 2, 2))
    if draw.has("texture offset", 0.3):
        text += "-o {:.3f} {:.3f} 0 ".format(*draw.uniform(-0.5, 0.5, 2))
    return text


def _image(draw: Draw, folder: Path, name: str) -> str:
    name = f"image {name}" if draw.has("image name with a blank", 0.2) else name
    save_png(folder / name, draw.image())
    return name
