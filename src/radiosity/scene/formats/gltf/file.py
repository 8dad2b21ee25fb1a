"""A glTF 2.0 file as JSON and bytes: chunks, buffers, views.

Read here with numpy and not through trimesh, which takes sparse and normalised accessors for something else in
silence, drops what it cannot load, and loses names and emissive strength.
"""

import json
import re
from base64 import b64decode
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, unquote_to_bytes

from ....errors import SceneError, shown
from ...parts import ReadOptions
from ..beside import in_any_case
from .glb import chunks

COMPRESSED = ("KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression")
UNPACK = "export it without compression (in Blender: untick Compression), or unpack it: gltf-transform copy in.glb out.glb"


@dataclass(frozen=True, eq=False)
class GltfFile:
    """A file that is parsed but not interpreted. Every lookup raises a `SceneError` that names what is wrong."""

    path: Path
    options: ReadOptions
    tree: dict
    chunk: bytes | None = None  # of a .glb
    known: dict = field(default_factory=dict)  # buffers already read
    renamed: list[tuple[str, Path]] = field(default_factory=list)  # found under a name of other case

    def fail(self, text: str) -> SceneError:
        return SceneError(f"{self.path}: {text}")

    def items(self, holder, key: str) -> list:
        """A list of the JSON, empty where absent."""
        value = holder.get(key, [])
        if not isinstance(value, list):
            raise self.fail(f"'{key}' is no list; the file does not follow glTF 2.0")
        return value

    def item(self, kind: str, index) -> dict:
        """``tree[kind][index]``."""
        items = self.items(self.tree, kind)
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(items):
            raise self.fail(f"{kind} {index!r} is referred to, but there are {len(items)} {kind} (from 0)")
        return self.dictionary(items[index], f"{kind} {index}")

    def dictionary(self, value, what: str) -> dict:
        if not isinstance(value, dict):
            raise self.fail(f"{what} is {type(value).__name__}, not an object; the file does not follow glTF 2.0")
        return value

    def whole(self, holder: dict, key: str, what: str, default: int | None = None) -> int:
        """A whole number of 0 or more."""
        value = holder.get(key, default)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value < 2**53 or value != int(value):
            raise self.fail(f"{key} of {what} is {value!r}; expected a whole number of 0 or more")
        return int(value)

    def numbers(self, holder: dict, key: str, default: tuple, what: str) -> tuple[float, ...]:
        """Finite numbers, as many as the default has."""
        value = holder.get(key, default)
        good = isinstance(value, (list, tuple)) and len(value) == len(default)
        if not good or not all(isinstance(v, (int, float)) and not isinstance(v, bool) and abs(v) < 1e38 for v in value):
            raise self.fail(f"{key} of {what} is {value!r}; expected {len(default)} finite numbers")
        return tuple(float(v) for v in value)

    def resource(self, uri, what: str) -> bytes:
        """The bytes behind a URI: a data URI or a file beside this one."""
        if not isinstance(uri, str):
            raise self.fail(f"uri of {what} is {uri!r}; expected text")
        if uri.startswith("data:"):
            head, _, body = uri.partition(",")
            try:
                return b64decode(body, validate=False) if head.endswith(";base64") else unquote_to_bytes(body)
            except ValueError as error:
                raise self.fail(f"the data URI of {what} cannot be decoded ({error})") from None
        if re.match(r"[A-Za-z][A-Za-z0-9+.-]+:", uri):  # one letter alone is a drive
            raise self.fail(f"{what} is at '{uri[:80]}': nothing is fetched from addresses; put the file beside this one")
        try:
            file = self.options.admit(self.path.parent / unquote(uri), self.path)
            if not file.is_file() and (other := in_any_case(self.path.parent, unquote(uri))):
                self.renamed.append((uri, other))
                file = self.options.admit(other, self.path)
            if not file.is_file():
                raise self.fail(f"{what} is in '{uri}', but there is no file {file}; put it there or export as .glb")
            return file.read_bytes()
        except (ValueError, OSError) as error:
            if isinstance(error, SceneError):
                raise
            raise self.fail(f"{what} is in {uri[:80]!r}, which cannot be read ({error})") from None

    def buffer(self, index) -> bytes:
        info = self.item("buffers", index)
        if index not in self.known:
            what = f"buffer {index}"
            if "uri" not in info and (packed := set(self.dictionary(info.get("extensions", {}), what)) & set(COMPRESSED)):
                raise self.fail(f"{what} is compressed with {shown(packed)}, which is not read; {UNPACK}")
            if "uri" not in info and (index != 0 or self.chunk is None):
                raise self.fail(f"{what} has no uri and the file has no binary chunk for it")
            data = self.resource(info["uri"], what) if "uri" in info else self.chunk or b""
            size = self.whole(info, "byteLength", what)
            if len(data) < size:
                raise self.fail(f"{what} has {len(data)} bytes where {size} are announced; the file is truncated")
            self.known[index] = data[:size]
        return self.known[index]

    def view(self, index) -> tuple[memoryview, int]:
        """Bytes of a buffer view, which are not copied, and its stride (0: tightly packed)."""
        info, what = self.item("bufferViews", index), f"buffer view {index}"
        data = self.buffer(info.get("buffer"))
        start, size = self.whole(info, "byteOffset", what, 0), self.whole(info, "byteLength", what)
        if start + size > len(data):
            raise self.fail(f"{what} ends at byte {start + size} of a buffer of {len(data)}; the file is damaged")
        return memoryview(data)[start : start + size], self.whole(info, "byteStride", what, 0)


def load(path: Path, options: ReadOptions) -> GltfFile:
    """Read and check the outer layers of a .glb or .gltf file.

    Raises:
        SceneError: truncated, or not glTF 2.0.
    """
    data = path.read_bytes()
    text, chunk = chunks(path, data) if path.suffix.lower() == ".glb" or data[:4] == b"glTF" else (data, None)
    try:
        tree = json.loads(text.decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise SceneError(f"{path}: its JSON cannot be parsed ({error}); the file is damaged or no glTF") from None
    if not isinstance(tree, dict) or not isinstance(tree.get("asset"), dict):
        raise SceneError(f"{path}: no glTF file: its JSON has no 'asset'")
    version = str(tree["asset"].get("version"))
    if not version.startswith("2."):
        raise SceneError(f"{path}: glTF version {version}; only 2.0 is read")
    return GltfFile(path, options, tree, chunk)
