"""The binary container of glTF."""

from pathlib import Path

from ....errors import SceneError


def chunks(path: Path, data: bytes) -> tuple[bytes, bytes | None]:
    """JSON text and binary chunk of a .glb file.

    Raises:
        SceneError: truncated or damaged.
    """
    if data[:4] != b"glTF":
        raise SceneError(f"{path}: does not begin like a .glb file; it is damaged or of another format")
    if len(data) < 20:
        raise SceneError(f"{path}: {len(data)} bytes are too few for a .glb file; it is truncated")
    version, length = (int.from_bytes(data[i : i + 4], "little") for i in (4, 8))
    if version != 2:
        raise SceneError(f"{path}: glTF version {version}; only 2.0 is read")
    if length > len(data):
        raise SceneError(f"{path}: the file is truncated: its header announces {length} bytes, it has {len(data)}")
    found: dict[bytes, bytes] = {}
    at = 12
    while at + 8 <= length:
        size, kind = int.from_bytes(data[at : at + 4], "little"), data[at + 4 : at + 8]
        if at + 8 + size > length:
            raise SceneError(
                f"{path}: the chunk at byte {at} announces {size} bytes, {length - at - 8} are left; the file is damaged"
            )
        if not found and kind != b"JSON":
            raise SceneError(f"{path}: the first chunk is {kind!r}, not JSON; the file is damaged")
        found.setdefault(kind, data[at + 8 : at + 8 + size])
        at += 8 + size
    if b"JSON" not in found:
        raise SceneError(f"{path}: the file has no JSON chunk; it is truncated")
    return found[b"JSON"], found.get(b"BIN\0")
