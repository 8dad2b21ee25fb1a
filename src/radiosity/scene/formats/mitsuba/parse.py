"""A Mitsuba XML file as a tree of plain values, read by Mitsuba's own parser.

Parameters, includes, references, file versions and transformations are Mitsuba's work. Its plugins are left alone: meshes
and scenes are not built by it, since damaged ones end the process.
"""

from pathlib import Path
from typing import Any

import numpy as np

from ....errors import SceneError
from ...parts import ReadOptions
from .inspection import check
from .node import Node, Spectrum


def parse(path: Path, options: ReadOptions) -> tuple[Node, list[Path]]:
    """The scene node of a file, and the folders where it looks for others.

    Raises:
        SceneError: malformed XML, or what Mitsuba refuses: its message, with line and column.
    """
    check(path, options)
    import mitsuba as package
    import mitsuba.scalar_rgb  # its types, by its own module: the variant that a user has set stays as it is

    mitsuba: Any = package  # its stubs do not know all that it takes
    parser = mitsuba.parser
    config = parser.ParserConfig("scalar_rgb")
    config.merge_equivalent = config.merge_meshes = config.parallel = False
    before = mitsuba.file_resolver()
    resolver = mitsuba.FileResolver(before)
    resolver.prepend(str(path.parent.resolve()))
    mitsuba.set_file_resolver(resolver)
    try:
        state = parser.parse_file(config, str(path))
        parser.transform_all(config, state)
        nodes = [_node(mitsuba, state, index) for index in range(len(state.nodes))]
        for index, node in enumerate(nodes):
            _link(mitsuba, node, state.nodes[index].props, nodes)
    except Exception as error:  # of many classes
        raise SceneError(message(error, path)) from None
    finally:
        mitsuba.set_file_resolver(before)
    if nodes[0].kind != "Scene":
        raise SceneError(f"{path}: the file describes a '{nodes[0].plugin}'; the outermost element must be <scene>")
    return nodes[0], [path.parent, *(Path(str(folder)) for folder in resolver)]


def message(error: Exception, path: Path) -> str:
    """Mitsuba's message on one line, without the places in its source."""
    lines = [line.split("] ", 1)[-1] if line.startswith("[") else line for line in str(error).splitlines()]
    text = " ".join(" ".join(line.split()) for line in lines)[:500]
    return text if str(path) in text else f"{path}: {text}"


def _node(mitsuba, state, index: int) -> Node:
    node = state.nodes[index]
    place = mitsuba.parser.file_location(state, node)
    result = Node(str(node.type).rsplit(".", 1)[-1], node.props.plugin_name(), node.props.id(), place)
    for key in list(node.props.keys()):
        value = node.props.get(key)
        if not isinstance(value, mitsuba.Properties.ResolvedReference):
            result.values[key] = _plain(mitsuba, value)
    return result


def _link(mitsuba, node: Node, props, nodes: list[Node]) -> None:
    for key in list(props.keys()):
        value = props.get(key)
        if isinstance(value, mitsuba.Properties.ResolvedReference):
            child = nodes[value.index()]
            node.children.append((key, child))
            if not child.name and not key.startswith("_arg_"):
                child.name = key


def _plain(mitsuba, value):
    if isinstance(value, (bool, int, float, str)):
        return value
    if hasattr(value, "is_uniform"):  # a property's spectrum; what mitsuba.Spectrum is depends on the variant set
        return Spectrum(() if value.is_uniform() else tuple(value.wavelengths), tuple(value.values))
    # a colour has any attribute that its letters spell, "matrix" too: ask for the type
    return np.array(value.matrix if "Transform" in type(value).__name__ else value, np.float64)
