"""Luminaires from files and from plain numbers, placed and aimed: what Python programs and .toml scenes give."""

import os
import warnings
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...errors import RadiosityWarning, SceneError
from ..habits import warn
from . import eulumdat, ies, webs
from .axes import up_of
from .color import bands_of
from .frames import frame, point
from .luminaire import Luminaire
from .photometry import Photometry
from .web import Web

READERS = {".ies": ies.read, ".ldt": eulumdat.read}
DOWN = (0.0, 0.0, -1.0)
LARGEST = 1e18


@dataclass(frozen=True)
class Placing:
    """The place of a luminaire, how it is turned, and how much light it sends; see `read_luminaire`."""

    position: Any
    aim: Any = None
    direction: Any = None
    rotate: float = 0.0
    along: Any = None
    lumens: float | None = None
    maintenance: float = 1.0
    color: Any = None
    group: str = ""
    name: str | None = None
    soft: bool = False
    up: Any = "z"

    def luminaire(self, web: Web, flux: float, what: str, **more) -> Luminaire:
        """Return a luminaire of a web that sends ``flux``.

        Raises:
            SceneError: a value makes no sense.
        """
        if self.aim is not None and self.direction is not None:
            raise SceneError(f"{what}: aim and direction exclude each other; give the point that it is aimed at, or a direction")
        place = point(self.position, "position", what)
        way = DOWN if self.direction is None else self.direction
        if self.aim is not None:
            way = point(self.aim, "aim", what) - place
            if not np.linalg.norm(way) > 0:
                raise SceneError(f"{what}: is aimed at its own place, {place.tolist()}; move aim")
        if not 0 < self.maintenance <= 1:
            raise SceneError(f"{what}: maintenance is {self.maintenance}; the share of the light that is left must lie in (0, 1]")
        if self.lumens is not None:
            flux = self.lumens
        if not 0 < flux < LARGEST:
            raise SceneError(f"{what}: sends {flux}; the light must be a number above zero")
        power = flux * self.maintenance * bands_of(self.color, what)
        axes = frame(way, self.rotate, self.along, what)
        size = more.pop("size", np.zeros(3))
        if self.soft and not size[:2].any():
            raise SceneError(f"{what}: is soft, and its file has no luminous size; leave soft out")
        return Luminaire(self.name or what, place, axes, web, power, size, self.group, soft=self.soft, **more)


def load_photometry(file: str | os.PathLike, *, lamp_set: int | None = None) -> Photometry:
    """Read a luminaire file: what it says of the light, and what in it differs.

    Args:
        file: path of an IES (.ies) or EULUMDAT (.ldt) file.
        lamp_set: the lamp set of a EULUMDAT file that is mounted; default: the first, with a note where there are several.

    Raises:
        SceneError: the file cannot be read; the message names the line and the value.

    Example:
        >>> import pathlib
        >>> web = ["TILT=NONE", "1 -1 1 3 1 1 2 0.2 0.2 0", "1 1 15", "0 45 90", "0", "600 300 0"]
        >>> _ = pathlib.Path("downlight.ies").write_text("\\n".join(["IESNA:LM-63-2002", *web]))
        >>> print(f"{rd.load_photometry('downlight.ies').flux:.0f} lm")
        1370 lm
    """
    path = Path(file)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise SceneError(f"{path}: unknown kind of luminaire file '{path.suffix}'; known are {', '.join(READERS)}")
    try:
        if lamp_set is not None and reader is not eulumdat.read:
            raise SceneError(f"{path}: lamp_set is for EULUMDAT files; an IES file has one set of lamps")
        with np.errstate(all="ignore"):  # numbers out of range are found by the checks
            return reader(path) if lamp_set is None else eulumdat.read(path, lamp_set)
    except SceneError:
        raise
    except Exception as error:  # damage that no check knows
        raise SceneError(f"{path}: cannot be read ({type(error).__name__}: {error}); is it damaged?") from error


def read_luminaire(
    file: str | os.PathLike | Photometry,
    *,
    position: ArrayLike,
    aim: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    rotate: float = 0.0,
    along: ArrayLike | None = None,
    lumens: float | None = None,
    maintenance: float = 1.0,
    color: ArrayLike | None = None,
    group: str = "",
    name: str | None = None,
    soft: bool = False,
    lamp_set: int | None = None,
    up: ArrayLike | str = "z",
) -> Luminaire:
    """Read a luminaire file, and place it. `Scene.with_lights` adds it to a scene.

    Args:
        file: path of an IES (.ies) or EULUMDAT (.ldt) file, or what `load_photometry` gave, for many of one kind.
        position: (3,) metres, of the middle of its luminous area.
        aim: (3,) metres, a point that gamma = 0 goes to. Default: straight down, along -z.
        direction: (3,), the direction of gamma = 0, instead of ``aim``.
        rotate: degrees about this direction, from C = 0 towards C = 90. One that hangs has C = 0 along x, and C = 90 along y.
        along: (3,), a direction in whose half plane C = 0 lies, before ``rotate``; default: x, tilted with the luminaire by the
            shortest turn.
        lumens: what it sends, instead of what the file says.
        maintenance: the share of the light that is left when the lamp is old and dirty, in (0, 1].
        color: (3,), of linear red, green and blue, in proportion; the lumens stay. Default: white.
        group: a name; luminaires of a group are dimmed together.
        name: default: that in the file.
        soft: light leaves from the whole luminous area of the file, so that shadows are soft; default: from its middle.
        lamp_set: see `load_photometry`.
        up: "z" or "y", or a direction. Where a file has factors of light for tilts (TILT), they count from straight down.

    Raises:
        SceneError: the file cannot be read, or a value makes no sense.

    Example:
        >>> import pathlib
        >>> web = ["TILT=NONE", "1 -1 1 3 1 1 2 0.2 0.2 0", "1 1 15", "0 45 90", "0", "600 300 0"]
        >>> _ = pathlib.Path("downlight.ies").write_text("\\n".join(["IESNA:LM-63-2002", *web]))
        >>> lamp = rd.read_luminaire("downlight.ies", position=(2.0, 1.5, 2.8), maintenance=0.8)
        >>> print(lamp.name, f"{lamp.power[0]:.0f} lm")
        downlight 1096 lm
    """
    photometry = file if isinstance(file, Photometry) else load_photometry(file, lamp_set=lamp_set)
    if not isinstance(file, Photometry):
        tell(photometry)
    called = name or photometry.name
    placing = Placing(position, aim, direction, rotate, along, lumens, maintenance, color, group, called, soft, up)
    return placed(photometry, placing)


def placed(photometry: Photometry, placing: Placing) -> Luminaire:
    """Return a luminaire of a file."""
    what = f"luminaire '{placing.name or photometry.name}'"
    luminaire = placing.luminaire(
        photometry.web, photometry.flux, what, size=photometry.size, disc=photometry.disc, source=photometry.source
    )
    power = luminaire.power if placing.lumens is not None else luminaire.power * _of_tilt(photometry, luminaire, placing.up, what)
    return replace(luminaire, name=placing.name or photometry.name, power=power)


def _of_tilt(photometry: Photometry, luminaire: Luminaire, up: Any, what: str) -> float:
    """Return the factor of the lamp's light for where a luminaire is aimed.

    Raises:
        SceneError: the factor is 0.
    """
    tilt = photometry.tilt
    if tilt is None:
        return 1.0
    angle = float(np.degrees(np.arccos(np.clip(-luminaire.axes[2] @ up_of(up), -1, 1))))
    if not tilt.reaches(angle):
        ends = f"{tilt.angles[0]:g} to {tilt.angles[-1]:g}"
        text = f"is tilted by {angle:.1f} degrees, and the factors of its file (TILT) are for {ends}"
        warn(f"{what}: {text}; that of the end is taken")
    factor = tilt.at(angle)
    if not factor > 0:
        raise SceneError(f"{what}: its lamp gives no light at a tilt of {angle:.1f} degrees (TILT); aim it elsewhere")
    return factor


def tell(photometry: Photometry) -> None:
    """Warn of what a file's reader found."""
    for note in photometry.notes:
        warnings.warn(f"{photometry.source}: {note}", RadiosityWarning, stacklevel=3)


def point_light(
    *,
    position: ArrayLike,
    lumens: float | None = None,
    watts: float | None = None,
    intensity: float | None = None,
    beam: float | None = None,
    field: float | None = None,
    aim: ArrayLike | None = None,
    direction: ArrayLike | None = None,
    maintenance: float = 1.0,
    color: ArrayLike | None = None,
    group: str = "",
    name: str | None = None,
) -> Luminaire:
    """Return a lamp at a point: alike in all directions, or a spot where a beam is given.

    Args:
        position: (3,) metres.
        lumens: lm that it sends in all directions together. Of lumens, watts and intensity give one.
        watts: the same in W of light, for scenes in W/m².
        intensity: cd, the largest one.
        beam: degrees, the full angle between the directions of half the intensity.
        field: degrees, that of a tenth; default: 1.82 times the beam, of a Gaussian.
        aim, direction, maintenance, color, group, name: see `read_luminaire`.

    Raises:
        SceneError: a value makes no sense.

    Example:
        >>> lamp = rd.point_light(position=(1.0, 1.0, 2.0), lumens=800)
        >>> spot = rd.point_light(position=(2.0, 1.0, 2.5), intensity=3000, beam=20, aim=(2.0, 0.0, 1.0))
        >>> print(f"{lamp.power[0]:.0f} lm, {spot.power[0]:.0f} lm")
        800 lm, 411 lm
    """
    kind = "point" if beam is None else "spot"
    what = f"{kind} light '{name}'" if name else f"{kind} light"
    given = {key: value for key, value in (("lumens", lumens), ("watts", watts), ("intensity", intensity)) if value is not None}
    if len(given) != 1:
        raise SceneError(f"{what}: {', '.join(given) or 'no light'} given; give one of lumens, watts and intensity")
    if beam is None and field is not None:
        raise SceneError(f"{what}: has a field of {field} degrees and no beam; give beam, too")
    web = webs.uniform() if beam is None else webs.spot(beam, field, what)
    (key, value), placing = (
        next(iter(given.items())),
        Placing(position, aim, direction, 0.0, None, None, maintenance, color, group),
    )
    flux = value * web.flux if key == "intensity" else value
    return replace(placing.luminaire(web, flux, what, photometric=key != "watts"), name=name or kind)
