"""All lights without area of a scene as one table of rows."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import drjit as dr
import numpy as np

from ...scene.model import Scene
from .ball import Ball
from .base import AbstractLights, AbstractPointLights, AbstractSky
from .luminaires import Luminaires
from .opening_lines import OpeningLines
from .sky import SkyRows
from .suns import Suns
from .through import Beside, SkyThrough, SunsThrough


@dataclass(frozen=True, eq=False)
class AllLights(AbstractLights):
    """Lights of several kinds, one after the other.

    Attributes:
        kinds: those that shadow rays can go to come first.
    """

    kinds: tuple[AbstractLights, ...]

    @cached_property
    def power(self) -> np.ndarray:
        return np.concatenate([kind.power for kind in self.kinds])

    @cached_property
    def starts(self) -> np.ndarray:
        """The first row of each kind, and the number of rows, (n_kinds + 1,) int64."""
        return np.cumsum([0, *(len(kind.power) for kind in self.kinds)])

    @property
    def is_through(self) -> np.ndarray:
        """True for rows of lines through openings, (n_lights,) bool."""
        return np.repeat([isinstance(kind, (SunsThrough, SkyThrough)) for kind in self.kinds], np.diff(self.starts))

    @cached_property
    def points(self) -> "AllLights | None":
        """The lights that shadow rays can go to, whose rows are the first; None where there are none."""
        kinds = tuple(kind for kind in self.kinds if isinstance(kind, AbstractPointLights))
        return AllLights(kinds) if kinds else None

    @property
    def sky(self) -> AbstractSky | None:
        """The sky, where there is one."""
        return next((kind for kind in self.kinds if isinstance(kind, AbstractSky)), None)

    def prepare(self, geometry: Any) -> None:
        for kind in self.kinds:
            kind.prepare(geometry)

    def leave(self, light: Any, numbers: Any) -> tuple[Any, Any]:
        return self.leave_where(light, numbers, True)

    def leave_where(self, light: Any, numbers: Any, active: Any) -> tuple[Any, Any]:
        return self._of_kind(light, lambda kind, number, here: kind.leave_where(number, numbers, active & here))

    def arrive(self, light: Any, point: Any, numbers: Any) -> tuple[Any, Any, Any]:
        """See `AbstractPointLights.arrive`; all kinds must be such."""
        return self._of_kind(light, lambda kind, number, here: kind.arrive(number, point, numbers))

    def _of_kind(self, light: Any, result: Any) -> tuple:
        """Return what each light's kind says of it, from its number among all and among its kind."""
        found = None
        for kind, start in zip(self.kinds, self.starts, strict=False):
            last = len(kind.power) - 1
            here = light >= int(start)
            number = dr.minimum(dr.select(here, light - int(start), 0), last)
            new = result(kind, number, here & (light <= int(start) + last))
            found = new if found is None else tuple(dr.select(here, one, old) for one, old in zip(new, found, strict=True))
        assert found is not None
        return found


def lights_of(scene: Scene, n_bands: int, through: bool = False) -> AllLights | None:
    """Return the lights of a scene as rows; None where it has none.

    Args:
        n_bands: of what is solved for.
        through: lines of the sky and of suns through the scene's openings are rows of their own, the last ones.
    """
    lights, sky = scene.lights, scene.lights.sky
    kinds: list[AbstractLights] = [Luminaires(lights.luminaires, n_bands)] if lights.luminaires else []
    if sky is not None and not sky.flux.any():
        sky = None
    if sky is None and not lights.suns:
        return AllLights(tuple(kinds)) if kinds else None
    corners = lights.openings if through and lights.openings is not None and len(lights.openings) else None
    ball = Ball.about(scene, None if corners is None else corners.reshape(-1, 3))
    suns = [Suns.of(lights.suns, n_bands, ball)] if lights.suns else []
    skies = [] if sky is None else [SkyRows(sky, n_bands, ball)]
    if corners is None:
        return AllLights((*kinds, *suns, *skies))
    openings = OpeningLines(corners, ball)
    beside = [Beside(kind, openings) for kind in (*suns, *skies)]
    return AllLights((*kinds, *beside, *(SunsThrough(s, openings) for s in suns), *(SkyThrough(s, openings) for s in skies)))
