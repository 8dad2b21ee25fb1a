"""Values of Blender's shader nodes at points of a mesh: the few nodes that importers make. Needs only numpy."""

import numpy as np
from images import spots


class Points:
    """Points in each triangle of a mesh.

    Attributes:
        weights: (k, 3) of the corners.
    """

    def __init__(self, mesh, triangles, count: int):
        self.weights = spots(count)
        self._mesh, self._triangles = mesh, triangles

    def spread(self, corners) -> np.ndarray:
        """(n * k, c) values from those of the corners (n, 3, c)."""
        corners = np.asarray(corners, float)
        return np.einsum("kc,ncd->nkd", self.weights, corners).reshape(-1, corners.shape[-1])

    def means(self, values) -> np.ndarray:
        """(n, 3) of each triangle."""
        count = len(self._triangles) * len(self.weights)
        values = np.broadcast_to(np.asarray(values, float).reshape(-1, np.shape(values)[-1])[..., :3], (count, 3))
        return values.reshape(len(self._triangles), -1, 3).mean(axis=1)

    def coordinates(self, name: str) -> np.ndarray:
        layers = self._mesh.uv_layers
        if not layers:
            return np.zeros((1, 3))
        layer = layers[name] if name else layers[0]
        uv = self.spread([[layer.data[i].uv for i in t.loops] for t in self._triangles])
        return np.column_stack([uv, np.zeros(len(uv))])

    def attribute(self, name: str) -> np.ndarray:
        layers = self._mesh.color_attributes
        if not layers or (name and name not in layers):
            return np.zeros((1, 4))
        layer = layers[name] if name else layers[0]
        by_corner = layer.domain == "CORNER"
        return self.spread([[layer.data[i].color for i in (t.loops if by_corner else t.vertices)] for t in self._triangles])


def value(node, name: str, points: Points) -> np.ndarray:
    """(1 or n, c) of an input of a node; Blender's default where there is no shader."""
    if node is None:
        return np.array([[0.8, 0.8, 0.8]]) if name == "Base Color" else np.zeros((1, 3))
    socket = node.inputs[name] if isinstance(name, str) else name
    if socket.is_linked:
        link = socket.links[0]
        return _output(link.from_node, link.from_socket.name, points)
    default = socket.default_value
    return np.atleast_2d(np.array(default if hasattr(default, "__len__") else [default], float))


def _output(node, socket: str, points: Points) -> np.ndarray:
    if node.type not in NODES:
        raise ValueError(f"the shader node {node.type} is not known here")
    return NODES[node.type](node, socket, points)


def _image(node, socket, points):
    image = node.image
    width, height = image.size
    pixels = np.array(image.pixels[:]).reshape(height, width, 4)  # row 0 at the bottom
    if image.colorspace_settings.name == "sRGB" and not image.is_float:
        low = pixels[..., :3] <= 0.04045
        pixels[..., :3] = np.where(low, pixels[..., :3] / 12.92, ((pixels[..., :3] + 0.055) / 1.055) ** 2.4)
    linked = node.inputs["Vector"].is_linked
    uv = value(node, "Vector", points) if linked else points.coordinates("")
    x, y = uv[:, 0] * width, uv[:, 1] * height
    if node.interpolation == "Closest":
        return pixels[_texel(np.floor(y), height, node.extension), _texel(np.floor(x), width, node.extension)]
    x, y = x - 0.5, y - 0.5
    fx, fy = (x - np.floor(x))[:, None], (y - np.floor(y))[:, None]
    columns = [_texel(np.floor(x) + i, width, node.extension) for i in (0, 1)]
    rows = [_texel(np.floor(y) + i, height, node.extension) for i in (0, 1)]
    lower = pixels[rows[0], columns[0]] * (1 - fx) + pixels[rows[0], columns[1]] * fx
    upper = pixels[rows[1], columns[0]] * (1 - fx) + pixels[rows[1], columns[1]] * fx
    return lower * (1 - fy) + upper * fy


def _texel(index, size: int, extension: str):
    index = index.astype(int)
    if extension == "EXTEND":
        return np.clip(index, 0, size - 1)
    if extension == "MIRROR":
        index = index % (2 * size)
        return np.where(index < size, index, 2 * size - 1 - index)
    return index % size


def _mix(node, socket, points):
    data = {"RGBA": "RGBA", "FLOAT": "VALUE", "VECTOR": "VECTOR"}[node.data_type]
    factor, first, second = (
        value(node, next(i for i in node.inputs if i.name == name and i.type == kind and i.enabled), points)
        for name, kind in (("Factor", "VALUE"), ("A", data), ("B", data))
    )
    first, second = first[:, :3], second[:, :3]
    blended = first * second if node.blend_type == "MULTIPLY" else second
    return first * (1 - factor) + blended * factor


def _mapping(node, socket, points):
    vector = value(node, "Vector", points)
    move, turn, scale = (value(node, name, points)[0] for name in ("Location", "Rotation", "Scale"))
    scaled = vector * scale
    c, s = np.cos(turn[2]), np.sin(turn[2])
    return np.column_stack([c * scaled[:, 0] - s * scaled[:, 1], s * scaled[:, 0] + c * scaled[:, 1], scaled[:, 2]]) + move


def _math(node, socket, points):
    one, two = (value(node, node.inputs[i], points) for i in (0, 1))
    if node.operation == "PINGPONG":
        return two - np.abs(np.mod(one, 2 * two) - two)
    if node.operation == "WRAP":  # between the third and the second value
        least = value(node, node.inputs[2], points)
        return one - (two - least) * np.floor((one - least) / (two - least))
    table = {
        "MULTIPLY": np.multiply,
        "ADD": np.add,
        "SUBTRACT": np.subtract,
        "MINIMUM": np.minimum,
        "MAXIMUM": np.maximum,
        "DIVIDE": np.divide,
        "FRACT": lambda a, b: a - np.floor(a),
    }
    result = table[node.operation](one, two)
    return np.clip(result, 0, 1) if node.use_clamp else result


def _separate(node, socket, points):
    return value(node, "Vector", points)[:, ["XYZ".index(socket)]]


def _combine(node, socket, points):
    return np.column_stack(np.broadcast_arrays(*(value(node, axis, points)[:, 0] for axis in "XYZ")))


def _constant(node, socket, points):
    default = node.outputs[0].default_value
    return np.atleast_2d(np.array(default if hasattr(default, "__len__") else [default], float))


NODES = {
    "TEX_IMAGE": _image,
    "UVMAP": lambda node, socket, points: points.coordinates(node.uv_map),
    "TEX_COORD": lambda node, socket, points: points.coordinates(""),
    "VERTEX_COLOR": lambda node, socket, points: points.attribute(node.layer_name),
    "ATTRIBUTE": lambda node, socket, points: points.attribute(node.attribute_name),
    "MIX": _mix,
    "MAPPING": _mapping,
    "MATH": _math,
    "SEPXYZ": _separate,
    "COMBXYZ": _combine,
    "RGB": _constant,
    "VALUE": _constant,
}
