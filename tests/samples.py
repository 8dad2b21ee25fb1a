"""Small valid files for the tests of the readers."""

import copy
import io
import json
import struct

import numpy as np

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
HALVES = [[0, 1, 2], [0, 2, 3]]
TRIANGLES = np.array(SQUARE)[[[0, 1, 2], [0, 2, 3]]]
MIXED = ([0, 1, 2, 3], [0, 1, 4], [4, 3, 2, 1, 0])
CORNERS = [[0, 1], [1, 1], [1, 0], [0, 0]]  # texture coordinates as glTF counts them, from the upper left


def png(pixels) -> bytes:
    """An image of (height, width, 3) whole numbers, 0 to 255."""
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.asarray(pixels, np.uint8)).save(file, "PNG")
    return file.getvalue()


class Gltf:
    """Builds a glTF tree with one buffer."""

    KINDS = {"f4": 5126, "u4": 5125, "u2": 5123, "u1": 5121, "i2": 5122}

    def __init__(self, **tree):
        self.tree = {"asset": {"version": "2.0"}, "accessors": [], "bufferViews": [], "meshes": [], "nodes": [], **tree}
        self.data = b""

    def view(self, data: bytes) -> int:
        self.data += b"\0" * (-len(self.data) % 4)
        self.tree["bufferViews"].append({"buffer": 0, "byteOffset": len(self.data), "byteLength": len(data)})
        self.data += data
        return len(self.tree["bufferViews"]) - 1

    def accessor(self, values, dtype="f4", **more) -> int:
        values = np.asarray(values, "<" + dtype)
        width = values.shape[1] if values.ndim > 1 else 1
        info = {"bufferView": self.view(values.tobytes()), "componentType": self.KINDS[dtype], "count": len(values)}
        kind = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}[width]
        self.tree["accessors"].append({**info, "type": kind, **more})
        return len(self.tree["accessors"]) - 1

    def image(self, pixels) -> int:
        """A texture of the pixels."""
        self.tree.setdefault("images", []).append({"bufferView": self.view(png(pixels)), "mimeType": "image/png"})
        self.tree.setdefault("textures", []).append({"source": len(self.tree["images"]) - 1})
        return len(self.tree["textures"]) - 1

    def mesh(self, vertices=SQUARE, faces=HALVES, material=None, attributes=None, name=None, **more) -> int:
        """A mesh of one primitive; ``attributes`` are accessor numbers."""
        primitive = {"attributes": {"POSITION": self.accessor(vertices), **(attributes or {})}, **more}
        if faces is not None:
            primitive["indices"] = self.accessor(np.ravel(faces), "u2")
        if material is not None:
            self.tree.setdefault("materials", []).append(copy.deepcopy(material))
            primitive["material"] = len(self.tree["materials"]) - 1
        self.tree["meshes"].append({"primitives": [primitive], **({"name": name} if name else {})})
        return len(self.tree["meshes"]) - 1

    def node(self, **info) -> int:
        self.tree["nodes"].append(info)
        return len(self.tree["nodes"]) - 1

    def glb(self) -> bytes:
        buffer = {"buffers": [{"byteLength": len(self.data)}]} if self.data else {}
        text = json.dumps({**self.tree, **buffer}).encode()
        text += b" " * (-len(text) % 4)
        data = self.data + b"\0" * (-len(self.data) % 4)
        chunks = struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(data)) + b"BIN\0" + data
        return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks

    def write(self, path):
        path.write_bytes(self.glb())
        return path


def box_gltf() -> Gltf:
    """A textured, coloured, emitting box whose faces are six squares."""
    import trimesh

    gltf = Gltf()
    box = trimesh.creation.box((2, 3, 4))
    vertices = box.vertices[box.faces].reshape(-1, 3)
    attributes = {
        "TEXCOORD_0": gltf.accessor(vertices[:, :2] / 4 + 0.5),
        "COLOR_0": gltf.accessor(np.full((len(vertices), 3), 0.5)),
    }
    texture = {"index": gltf.image(np.full((4, 4, 3), 188))}
    material = {
        "name": "paper",
        "doubleSided": True,
        "pbrMetallicRoughness": {"baseColorFactor": [0.8, 0.6, 0.4, 1.0], "baseColorTexture": texture, "metallicFactor": 0.0},
        "emissiveFactor": [1.0, 0.5, 0.25],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 10.0}},
    }
    gltf.node(mesh=gltf.mesh(vertices, np.arange(36), material, attributes), name="box")
    return gltf


def ply_text(vertices=SQUARE, faces=([0, 1, 2, 3],), colors=None, comment="") -> str:
    """An ASCII PLY file."""
    properties = "property float x\nproperty float y\nproperty float z\n"
    if colors is not None:
        properties += "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    rows = [[*v, *(colors[i] if colors is not None else ())] for i, v in enumerate(vertices)]
    return (
        f"ply\nformat ascii 1.0\n{comment}element vertex {len(vertices)}\n{properties}element face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
        + "".join(" ".join(map(str, row)) + "\n" for row in [*rows, *([len(f), *f] for f in faces)])
    )


def ply_bytes(vertices=SQUARE, faces=([0, 1, 2, 3],), order="<", counts=None) -> bytes:
    """A binary PLY file; ``counts`` replaces the numbers of rows that the header announces."""
    n_vertices, n_faces = counts or (len(vertices), len(faces))
    head = (
        f"ply\nformat binary_{'little' if order == '<' else 'big'}_endian 1.0\nelement vertex {n_vertices}\n"
        f"property float x\nproperty float y\nproperty float z\nelement face {n_faces}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    rows = b"".join(struct.pack(f"{order}B{len(face)}i", len(face), *face) for face in faces)
    return head.encode() + np.asarray(vertices, order + "f4").tobytes() + rows


def stl_bytes(triangles, count=None) -> bytes:
    """A binary STL file of (n, 3, 3) corners."""
    triangles = np.asarray(triangles, "<f4")
    rows = b"".join(b"\0" * 12 + corners.tobytes() + b"\0\0" for corners in triangles)
    return b"\0" * 80 + struct.pack("<I", len(triangles) if count is None else count) + rows


def stl_text(solids: dict) -> str:
    """An ASCII STL file of named solids, (n, 3, 3) corners each."""
    text = ""
    for name, triangles in solids.items():
        text += f"solid {name}\n"
        for corners in triangles:
            rows = "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners)
            text += f"facet normal 0 0 1\nouter loop\n{rows}endloop\nendfacet\n"
        text += f"endsolid {name}\n"
    return text


OBJ = """mtllib box.mtl
o room
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
g floor
usemtl white
f 1/1 2/2 3/3 4/4
g lamp
usemtl light
v 0 0 2
v 0 1 2
v 1 1 2
v 1 0 2
f -4 -3 -2 -1
"""
MTL = "newmtl white\nKd 0.5 0.5 0.5\nnewmtl light\nKd 0 0 0\nKe 3 2 1\n"


# ---- of many statements, to be damaged ------------------------------------------------------------------------------

VS3 = """T a box of 4 x 3 x 2.5 m
C encl=1 list=2 out=1 emit=1
F 3
!  #   x  y  z
V  1   0. 0. 0.
V  2   4. 0. 0.
V  3   4. 3. 0.
V  4   0. 3. 0.
V  5   0. 0. 2.5
V  6   4. 0. 2.5
V  7   4, 3, 2.5
V  8   0. 3. 2.5
!  #   v1 v2 v3 v4 base cmb  emit  name
S  1    1  2  3  4   0   0   0.90  floor
S  2    5  8  7  6   0   0   0.80  top!  ! the name is top!
S  3    1  5  6  2   0   0   0.05  walls
S  4    2  6  7  3   0   3   0.05  east
S  5    3  7  8  4   0   3   0.05  north
S  6    4  8  5  0   0   3   0.05  west-a
S  7    4  5  1  0   0   3   0.05  west-b
End of data
S  9    what comes here is not read
"""
TOML = """geometry = ["lamp.stl", {file = "room.ply", unit = "mm", scale = 2.5, name = "room"}]
unit = "cm"
photometric = false
[[surface]]
name = "lamp*"
reflectance = [0.1, 0.2, 0.3]
power = 40
sides = 1
[[surface]]
name = "room"
reflectance = 0.5
patch_size = 0.1
[[camera]]
origin = [0, 1, 2]
target = [1, 1, 2]
fov = 50
"""
XML_BEGIN = b"""<scene version="3.0.0"><default name="r" value="0.3"/>
<sensor type="perspective"><float name="fov" value="45"/><film type="hdrfilm"><integer name="width" value="32"/></film>
<transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform></sensor>
<bsdf type="twosided" id="w"><bsdf type="diffuse"><rgb name="reflectance" value="$r,.2,.1"/></bsdf></bsdf>
<shape type="rectangle" id="floor"><ref id="w"/></shape>
<shape type="obj"><string name="filename" value="mesh.obj"/><ref id="w"/></shape>
<shape type="cube"><bsdf type="plastic"><spectrum name="diffuse_reflectance" value="400:0.1, 700:0.9"/></bsdf>
<transform name="to_world"><rotate x="1" angle="20"/><scale value="-2"/></transform></shape>
<shape type="sphere"><float name="radius" value="2"/><emitter type="area"><rgb name="radiance" value="1,2,3"/></emitter></shape>
<shape type="cylinder"><bsdf type="diffuse"><texture type="checkerboard" name="reflectance"/></bsdf></shape>
"""
XML_END = b'<emitter type="constant"/></scene>'
MGF = b"""# comment
i part.mgf -a 3 -t 1 0 0
c red =
\tcxy 0.6 0.3
m paint = wall
\tc red
\trd 0.4
\ted 20
v a =
\tp 0 0 0
\tn 0 0 1
v b =
\tp 1 0 0
v c = b
\tp 1 1 0
o thing
xf -rx 30 -s 2 -a 2 -t 0 0 1
f a b c
xf
sph a .5
ring a 0 1
prism a b c 1
cone a 1 b 0
o
"""
