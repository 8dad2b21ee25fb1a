"""Lights of glTF files (KHR_lights_punctual): points and spots in cd, and directional lights in lux.

A light shines along the -z of its node, whose scale does not matter. Its colour multiplies the intensity of each band. A spot is
weakened between its cone angles as the specification says.
"""

import numpy as np

from ....errors import shown
from ...assemble import warn
from ...lights import webs
from ...lights.frames import frame
from ...lights.luminaire import Luminaire
from ...lights.model import Lights
from ...lights.sun import Sun
from .file import GltfFile
from .nodes import Node, extension

PUNCTUAL = "KHR_lights_punctual"
KINDS = ("point", "spot", "directional")
STEEPEST = 0.001  # least difference of the cosines of both cone angles


class PunctualLights:
    """A reader that collects the lights of a file's nodes.

    Attributes:
        found: the lights so far.
    """

    def __init__(self, file: GltfFile):
        self._file = file
        self._luminaires: list[Luminaire] = []
        self._suns: list[Sun] = []
        self._left_out: dict[str, list[str]] = {}

    @property
    def found(self) -> Lights:
        return Lights(tuple(self._luminaires), tuple(self._suns))

    def add(self, node: Node) -> None:
        """Add the light of a node, where it has one that shines.

        Raises:
            SceneError: there is no such light, or its numbers make none.
        """
        held = node.extension(self._file, PUNCTUAL)
        if held is None:
            return
        lights = extension(self._file, self._file.tree, PUNCTUAL, "the file") or {}
        listed, index, what = self._file.items(lights, "lights"), held.get("light"), f"the light of '{node.name}'"
        if not isinstance(index, int) or not 0 <= index < len(listed):
            raise self._file.fail(f"{what} is number {index!r}; the file has {len(listed)} (from 0)")
        light = self._file.dictionary(listed[index], what)
        kind = light.get("type")
        if kind not in KINDS:
            self._left_out.setdefault("lights of unknown types", []).append(f"{node.name} ({kind})")
            return
        (intensity,) = self._file.numbers({"v": [light.get("intensity", 1.0)]}, "v", (1.0,), f"intensity of {what}")
        color = np.array(self._file.numbers(light, "color", (1.0, 1.0, 1.0), what))
        if intensity < 0 or color.min() < 0:
            raise self._file.fail(f"{what} has intensity {intensity:g} and colour {color.tolist()}; both must not be negative")
        if "range" in light:
            self._left_out.setdefault("ranges of lights (light goes on beyond them)", []).append(node.name)
        values = intensity * (color[:1] if (color == color[0]).all() else color)
        if not values.any():
            return
        axes = self._axes(node, what)
        if kind == "directional":
            self._suns.append(Sun(node.name, -axes[2], values, 0.0))
            return
        web = webs.uniform() if kind == "point" else self._spot(light, what)
        self._luminaires.append(Luminaire(node.name, node.matrix[:3, 3], axes, web, values * web.flux, np.zeros(3)))

    def report(self, emissive: list[str]) -> None:
        """Tell once a kind what is left out, and that surfaces emit in the same unit.

        Args:
            emissive: names of surfaces that emit.
        """
        if emissive and self.found:
            text = (
                "emission is in cd/m², as the specification says, beside lights in cd and lux; some exporters mean another unit"
            )
            warn(f"{self._file.path}: {text}: {shown(dict.fromkeys(emissive))}")
        for what, names in self._left_out.items():
            warn(f"{self._file.path}: {what} are left out: {shown(dict.fromkeys(names))}")

    def _axes(self, node: Node, what: str) -> np.ndarray:
        along, right = -node.matrix[:3, 2], node.matrix[:3, 0]
        if not np.isfinite(node.matrix).all() or not np.linalg.norm(np.cross(along, right)) > 0:
            raise self._file.fail(f"{what} has a transformation without direction: {node.matrix[:3].tolist()}")
        return frame(along, 0.0, right, what)

    def _spot(self, light: dict, what: str):
        """Return the web of a spot of 1 cd."""
        spot = self._file.dictionary(light.get("spot", {}), f"spot of {what}")
        angles = (("innerConeAngle", 0.0), ("outerConeAngle", np.pi / 4))
        inner, outer = (
            self._file.numbers({"v": [spot.get(key, usual)]}, "v", (0.0,), f"{key} of {what}")[0] for key, usual in angles
        )
        if not 0 <= inner < outer <= np.pi / 2 + 1e-6:
            text = f"{what} has cone angles of {inner:g} and {outer:g}; expected 0 <= inner < outer <= pi / 2"
            raise self._file.fail(text)
        low, width = np.cos(outer), max(STEEPEST, np.cos(inner) - np.cos(outer))
        whole = np.arccos(min(low + width, 1.0))  # up to here
        return webs.cone(np.degrees(whole), np.degrees(outer), lambda angle: np.clip((np.cos(angle) - low) / width, 0, 1) ** 2)
