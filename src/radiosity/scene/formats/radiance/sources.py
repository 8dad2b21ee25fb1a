"""The sources of Radiance, lights that are infinitely far away, as suns and a sky."""

from dataclasses import dataclass, field

import numpy as np

from ...lights.axes import sky_axes
from ...lights.model import Lights
from ...lights.sky import Sky
from ...lights.sun import Sun
from ..curved import perpendicular
from . import told
from .modifiers import Chain
from .primitives import Primitive
from .sky_functions import ROWS, factors
from .told import Told

SHINING = {"light": 3, "glow": 4}  # how many numbers materials of sources have
MOST_SUN = 90.0  # degrees: larger discs are no suns
NEAR = 0.5  # degrees by which a half or the whole of the sphere may be missed
OPPOSITE = 1e-6  # cosine
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Half:
    """A half of the sky, or all of it.

    Attributes:
        name: of the source.
        towards: (3,) its middle; None: it is all around.
        radiance: (1 or 3,) W/(m² sr).
        pattern: (ROWS, COLUMNS) factors on the radiance, or None.
    """

    name: str
    towards: np.ndarray | None
    radiance: np.ndarray
    pattern: np.ndarray | None

    def table(self, rows: int) -> np.ndarray:
        """Radiances of so many rows, (rows, n_azimuths, n_bands)."""
        pattern = np.ones((rows, 1)) if self.pattern is None else self.pattern
        return pattern[:, :, None] * self.radiance


@dataclass
class Sources:
    """Suns and halves of the sky, as they are found."""

    suns: list[Sun] = field(default_factory=list)
    halves: list[Half] = field(default_factory=list)

    def add(self, source: Primitive, chain: Chain, telling: Told) -> None:
        """Take a source with its modifiers.

        Raises:
            ValueError: it has no direction or angle.
        """
        numbers = np.array(source.numbers)
        if len(numbers) != 4 or not np.linalg.norm(numbers[:3]) > 0:
            raise ValueError("a source has a direction and an angle, four numbers")
        material, towards, angle = chain.material, numbers[:3] / np.linalg.norm(numbers[:3]), float(numbers[3])
        if material is None or len(material.numbers) != SHINING.get(material.kind, -1):
            return telling.add(told.UNLIT, source.name)
        patterns = [one for one in chain.patterns if not one.kind.startswith("tex")]
        shape = factors(patterns[0]) if len(patterns) == 1 and abs(towards[2]) > 1 - OPPOSITE and angle > MOST_SUN else None
        if patterns and shape is None:
            return telling.add(told.SKIES, f"{source.name} ({patterns[0].kind} {patterns[0].name})")
        radiance = np.array(material.numbers[:3])
        if not (np.isfinite(radiance).all() and (radiance >= 0).all()):
            raise ValueError(f"its radiance is {radiance.tolist()}; it must be finite and not negative")
        radiance = radiance[:1] if np.ptp(radiance) == 0 else radiance
        if abs(angle - 360) < NEAR or abs(angle - 180) < NEAR:
            half = Half(source.name, None if angle > 270 else towards, radiance, shape)
            if self._overlaps(half):
                return telling.add(told.TWO_SKIES, source.name)
            self.halves.append(half)
        elif 0 < angle < MOST_SUN:
            irradiance = np.pi * np.sin(np.radians(angle) / 2) ** 2 * radiance
            self.suns.append(Sun(source.name, towards, irradiance, angle, photometric=False))
        else:
            telling.add(told.ANGLES, f"{source.name} ({angle:g} degrees)")

    def _overlaps(self, half: Half) -> bool:
        if not self.halves:
            return False
        one, other = self.halves[0].towards, half.towards
        return len(self.halves) > 1 or one is None or other is None or bool(one @ other > OPPOSITE - 1)

    def lights(self) -> Lights:
        """All of them; those of a colour have three bands."""
        return Lights(suns=tuple(self.suns), sky=self._sky())

    def _sky(self) -> Sky | None:
        """One half as the sky, and the other one as the ground; up is z unless they are halves of another axis."""
        if not self.halves:
            return None
        first = self.halves[0].towards
        up = UP if first is None or abs(first[2]) > 1 - OPPOSITE else first * np.copysign(1, first[2])
        above = next((half for half in self.halves if half.towards is None or half.towards @ up > 0), None)
        below = next((half for half in self.halves if half.towards is None or half.towards @ up < 0), None)
        patterned = any(half.pattern is not None for half in self.halves)
        rows = ROWS if patterned else 4
        lower, upper = (np.zeros((rows, 1, 1)) if half is None else half.table(rows) for half in (below, above))
        shape = np.broadcast_shapes(upper.shape, lower.shape)
        radiance = np.concatenate([np.broadcast_to(lower, shape)[: rows // 2], np.broadcast_to(upper, shape)[rows // 2 :]])
        axes = sky_axes() if up is UP else sky_axes(up, perpendicular(up)[0])
        kind = "of gensky or gendaylit" if patterned else "uniform"
        name = next(half.name for half in (above, below) if half is not None)
        return Sky(name, radiance, axes, kind, photometric=False)
