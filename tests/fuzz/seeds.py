"""Small valid files of every format that is read, and how number k of the damaged ones is made.

File k of a format is the same on every machine: all that is drawn comes from ``Random(f"{format} {k}")``.
"""

import base64
import io
import json
import struct
import tempfile
import zipfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from random import Random

import numpy as np
from luminaire_files import ies, ldt
from mutate import mutated
from samples import (
    MGF,
    MIXED,
    MTL,
    OBJ,
    SQUARE,
    TOML,
    TRIANGLES,
    VS3,
    XML_BEGIN,
    XML_END,
    box_gltf,
    ply_bytes,
    ply_text,
    png,
    stl_bytes,
    stl_text,
)

TEXTURED = OBJ.replace("usemtl white", "usemtl light").replace("f -4 -3 -2 -1", "f -4/1 -3/2 -2/3 -1/4")
XML = (
    XML_BEGIN
    + b"""<shape type="shapegroup" id="g"><shape type="disk"/></shape><shape type="instance"><ref id="g"/></shape>
<shape type="ply"><string name="filename" value="mesh.ply"/></shape>
<shape type="rectangle"><bsdf type="diffuse"><texture type="bitmap" name="reflectance"><string name="filename" value="wall.png"/>
</texture></bsdf></shape>"""
    + XML_END
)
LUMINAIRES = {
    "lamp.ies": ies(np.eye(37)[:3] + 1, horizontal=(0, 45, 90), tilt="TILT=INCLUDE\n1\n2\n0 90\n1 0.5", size=(-0.2, 0.4, 0)),
    "lamp.ldt": ldt(np.eye(37)[:5] + 1, range(0, 360, 45), symmetry=2, sets=((2, 3000.0), (-1, 500.0))),
}
RAD = b"""# a room
void plastic wall 0 0 5 .5 .6 .5 0 0
void colorpict print 7 red green blue a.hdr pic.cal u v 0 0
print trans cloth 0 0 7 .4 .4 .4 .1 0 .5 .5
void glass pane 0 0 3 .96 .96 .96
void light lamp 0 0 3 10 10 10
void alias lamps lamp
wall polygon "hole.1" 0 0 30 0 0 0 4 0 0 4 4 0 0 4 0 0 0 0 1 1 0 1 2 0 2 2 0 2 1 0 1 1 0
lamps sphere bulb 0 0 4 2 2 2 .1
cloth cone hat 0 0 8 1 1 0 1 1 1 .5 0
pane ring disk 0 0 8 1 1 1.5 0 0 -1 .1 .3
wall tube pipe 0 0 7 3 3 0 3 3 1 .5
void brightfunc skyfunc 2 skybr skybright.cal 0 3 2 41.6 6.5
skyfunc glow glows 0 0 4 1 1 1 0
glows source sky 0 0 4 0 0 1 180
lamp source sun 0 0 4 0 .6 .8 .533
"""
HBJSON = b"""{"type": "Model", "units": "Feet", "rooms": [{"identifier": "r", "faces": [{"identifier": "s", "face_type": "Wall",
"geometry": {"boundary": [[0, 0, 0], [4, 0, 0], [4, 0, 3], [0, 0, 3]], "holes": null}, "boundary_condition": {"type": "Outdoors"},
"apertures": [{"identifier": "w", "geometry": {"boundary": [[1, 0, 1], [3, 0, 1], [3, 0, 2], [1, 0, 2]]}, "is_operable": false}],
"doors": [], "properties": {"radiance": {"modifier": "paint"}}}]}], "shade_meshes": [{"identifier": "m", "geometry":
{"vertices": [[0, 0, 9], [2, 0, 9], [2, 2, 9], [0, 2, 9]], "faces": [[0, 1, 2, 3], [0, 1, 2]]}}], "properties": {"radiance":
{"modifiers": [{"type": "Plastic", "identifier": "paint", "r_reflectance": 0.3, "g_reflectance": 0.4, "b_reflectance": 0.3}],
"modifier_sets": [], "global_modifier_set": {"aperture_set": {"window_modifier": null}}}}}"""
PART = b"m wall =\n\tsides 1\n\trd .5\nv q =\n p 0 0 9\nv r =\n p 1 0 9\nv s =\n p 0 1 9\nf q r s\n"


@cache
def gltf_text() -> bytes:
    gltf = box_gltf()
    uri = "data:application/octet-stream;base64," + base64.b64encode(gltf.data).decode()
    gltf.tree["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}}]
    gltf.node(camera=0, translation=[0, 0, 9], rotation=[0, 0, 0, 1])
    return json.dumps({**gltf.tree, "buffers": [{"byteLength": len(gltf.data), "uri": uri}]}).encode()


@cache
def solution() -> dict[str, bytes]:
    """The members of a solution file: painted, three bands, two replicates."""
    import warnings

    import radiosity as rd

    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore", rd.RadiosityWarning)
        scene = rd.load_scene(box_gltf().write(Path(folder, "box.glb")))
        patches = rd.subdivide(scene, cells=2)
        rd.solve(patches, "random-walk", quanta=16, replicates=2, progress=None).save(Path(folder, "box.npz"))
        return _members(Path(folder, "box.npz"))


@cache
def line_set() -> dict[str, bytes]:
    """The members of a line set file: painted, three bands, two replicates, a source."""
    import radiosity as rd

    with tempfile.TemporaryDirectory() as folder:
        patches = rd.subdivide(rd.load_scene(box_gltf().write(Path(folder, "box.glb"))), cells=2)
        rd.trace_lines(patches, quanta=2_000, replicates=2, sources=patches.scene.names[:1]).save(Path(folder, "box.npz"))
        return _members(Path(folder, "box.npz"))


def _members(path: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(path) as file:
        return {name: file.read(name) for name in file.namelist()}


def _gltf(random: Random) -> dict[str, bytes]:
    return {"scene.gltf": mutated(gltf_text(), random)}


def _glb(random: Random) -> dict[str, bytes]:
    """Damage anywhere, or in one chunk with all lengths right."""
    data = box_gltf_bytes()
    if random.random() < 0.4:
        return {"scene.glb": mutated(data, random)}
    size = int.from_bytes(data[12:16], "little")
    text, chunk = data[20 : 20 + size], data[28 + size :]
    if random.random() < 0.5:
        text = mutated(text, random)
    else:
        chunk = mutated(chunk, random)
    return {"scene.glb": _packed(text, chunk)}


@cache
def box_gltf_bytes() -> bytes:
    return box_gltf().glb()


def _packed(text: bytes, chunk: bytes) -> bytes:
    body = struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(chunk)) + b"BIN\0" + chunk
    return b"glTF" + struct.pack("<II", 2, 12 + len(body)) + body


@cache
def picture() -> bytes:
    return png(np.arange(48).reshape(4, 4, 3))


def _glb_png(random: Random) -> dict[str, bytes]:
    """A square whose picture is damaged."""
    image = mutated(picture(), random)
    geometry = np.array(SQUARE, "<f4").tobytes() + np.array([[0, 0], [1, 0], [1, 1], [0, 1]], "<f4").tobytes()
    geometry += np.array([0, 1, 2, 0, 2, 3], "<u2").tobytes()
    places, sizes = (0, 48, 80, 92), (48, 32, 12, len(image))
    views = [{"buffer": 0, "byteOffset": at, "byteLength": size} for at, size in zip(places, sizes, strict=True)]
    kinds = ((5126, 4, "VEC3"), (5126, 4, "VEC2"), (5123, 6, "SCALAR"))
    accessors = [{"bufferView": i, "componentType": c, "count": n, "type": t} for i, (c, n, t) in enumerate(kinds)]
    tree = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 92 + len(image)}],
        "bufferViews": views,
        "accessors": accessors,
        "images": [{"bufferView": 3, "mimeType": "image/png"}],
        "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "nodes": [{"mesh": 0}],
    }
    return {"scene.glb": _packed(json.dumps(tree).encode(), geometry + image)}


def _obj(random: Random) -> dict[str, bytes]:
    files = {"scene.obj": TEXTURED.encode(), "wall.png": picture()}
    files["box.mtl"] = (MTL + "map_Kd -s 2 2 1 wall.png\nillum 2\nKs 0.1 0.1 0.1\nd 1\n").encode()
    name = random.choice(("scene.obj", "scene.obj", "box.mtl"))
    return {**files, name: mutated(files[name], random)}


def _daylight(random: Random) -> dict[str, bytes]:
    """A scene under the sky of an hour of a weather file, or a plainer one, with an opening."""
    sky = random.choice(("perez", "epw", "clear"))
    files = {"scene.toml": (DAYLIGHT + SKIES[sky]).encode(), "room.ply": ply_text().encode(), "a.epw": EPW.encode()}
    name = random.choice(("scene.toml", "a.epw" if sky == "epw" else "scene.toml"))
    return {**files, name: mutated(files[name], random)}


def _toml(random: Random) -> dict[str, bytes]:
    return {"scene.toml": mutated(TOML.encode(), random), "lamp.stl": stl_bytes(TRIANGLES), "room.ply": ply_text().encode()}


def _luminaire(name: str) -> Callable[[Random], dict[str, bytes]]:
    """Damaged luminaire files, which a sound scene names."""

    def files(random: Random) -> dict[str, bytes]:
        text = f'geometry = "room.ply"\n[[luminaire]]\nfile = "{name}"\nposition = [0, 0, 2]\n'
        return {"scene.toml": text.encode(), "room.ply": ply_text().encode(), name: mutated(LUMINAIRES[name].encode(), random)}

    return files


def _xml(random: Random) -> dict[str, bytes]:
    files = {"scene.xml": XML, "mesh.obj": OBJ.encode(), "mesh.ply": ply_bytes(), "wall.png": picture()}
    name = random.choice(("scene.xml",) * 6 + ("mesh.obj", "mesh.ply"))
    return {**files, name: mutated(files[name], random)}


def _mgf(random: Random) -> dict[str, bytes]:
    files = {"scene.mgf": MGF, "part.mgf": PART}
    name = random.choice(("scene.mgf", "scene.mgf", "part.mgf"))
    return {**files, name: mutated(files[name], random)}


def _npz(random: Random) -> dict[str, bytes]:
    return {"scene.npz": _archive(dict(solution()), random)}


def _lines(random: Random) -> dict[str, bytes]:
    return {"scene.lines.npz": _archive(dict(line_set()), random)}


def _archive(members: dict[str, bytes], random: Random) -> bytes:
    """Damage to the archive, or inside of members whose checksums are right."""
    where = random.random()
    if where > 0.1:
        names = ["meta.npy"] if where < 0.5 else random.sample(sorted(members), random.choice((1, 1, 2)))
        for name in names:
            members[name] = _npy(members[name], random)
        if random.random() < 0.05:
            members.pop(random.choice(sorted(members)))
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", random.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))) as archive:
        for name, data in members.items():
            archive.writestr(zipfile.ZipInfo(name), data)
    data = file.getvalue()
    return data if where > 0.1 else mutated(data, random)


def _npy(data: bytes, random: Random) -> bytes:
    """Damage to an array file; the text in ``meta`` stays an array of its own length."""
    if random.random() < 0.4:
        return mutated(data, random)
    value = np.load(io.BytesIO(data))
    if value.dtype.kind == "U":
        value = np.array(mutated(str(value).encode(), random).decode("utf-8", "replace").rstrip("\0") or " ")
    elif value.size:
        raw = mutated(value.tobytes(), random)[: value.nbytes]
        value = np.frombuffer(raw.ljust(value.nbytes, b"\0"), value.dtype).reshape(value.shape)
    out = io.BytesIO()
    np.save(out, value)
    return out.getvalue()


def _one(name: str, make):
    return lambda random: {name: mutated(make(), random)}


DAYLIGHT = """geometry = "room.ply"
[[surface]]
name = "*"
reflectance = 0.5
[[opening]]
corners = [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1.5]]
"""
SKIES = {
    "perez": "[sky]\ntype = 'perez'\ndirect = 600\ndiffuse = 90.5\naltitude = 30.5\nazimuth = 99\nup = 'z'\nnorth = [1, 0, 0]\n",
    "epw": "[sky]\ntype = 'epw'\nfile = 'a.epw'\nmonth = 6\nday = 21\nhour = 12\nground = 0.2\nopenings = ['*']\n",
    "clear": """[sky]
type = "cie-clear"
horizontal = 9000
[sun]
illuminance = 60_000
latitude = 52.5
longitude = 13.4
timezone = 1
month = 6
day = 21
hour = 10.5
""",
}
EPW = """LOCATION,Testville,-,DEU,Synthetic,000000,52.50,13.40,1.0,35.0
DATA PERIODS,1,1,Data,Sunday,1/1,12/31
2005,6,21,12,60,?9,20.1,14.0,50,101000,0,0,300,673,600,150,0,0,0,0,0,0,0,0
"""
COLORED = cache(lambda: ply_text([*SQUARE, [0, 0, 1]], MIXED, colors=np.arange(15).reshape(5, 3)).encode())
FORMATS = {
    "mgf": _mgf,
    "xml": _xml,
    "glb": _glb,
    "glb-png": _glb_png,
    "gltf": _gltf,
    "obj": _obj,
    "ply-ascii": _one("scene.ply", COLORED),
    "ply-binary": _one("scene.ply", lambda: ply_bytes([*SQUARE, [0, 0, 1]], MIXED)),
    "stl-ascii": _one("scene.stl", lambda: stl_text({"a": TRIANGLES, "b": TRIANGLES + 1}).encode()),
    "stl-binary": _one("scene.stl", lambda: stl_bytes(TRIANGLES)),
    "vs3": _one("scene.vs3", lambda: VS3.encode()),
    "rad": _one("scene.rad", lambda: RAD),
    "hbjson": _one("scene.hbjson", lambda: HBJSON),
    "toml": _toml,
    "daylight": _daylight,
    "ies": _luminaire("lamp.ies"),
    "ldt": _luminaire("lamp.ldt"),
    "npz": _npz,
    "lines": _lines,
}


def damaged(name: str, number: int) -> dict[str, bytes]:
    """The files, by name, of damaged file ``number`` of a format; the scene is the one called ``scene.*``."""
    return FORMATS[name](Random(f"{name} {number}"))
