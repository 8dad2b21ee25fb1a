"""The lights without area of a scene: they send light and receive none."""

import hashlib
from dataclasses import dataclass, fields, is_dataclass

import numpy as np

from .luminaire import Luminaire
from .sky import Sky
from .sun import Sun
from .web import Web


@dataclass(frozen=True, eq=False)
class Lights:
    """Lights of a scene that are no surfaces.

    Attributes:
        luminaires: lamps at points.
        suns: lights so far away that they stand in one direction.
        sky: what lines see that leave the scene; None: nothing.
        openings: (n, 4, 3) m, corners around polygons through which the sky and the suns light most of what matters, such as
            windows; a triangle repeats its last corner. More lines look through them. They stop no line, and no light is lost
            where they are left out.
    """

    luminaires: tuple[Luminaire, ...] = ()
    suns: tuple[Sun, ...] = ()
    sky: Sky | None = None
    openings: np.ndarray | None = None

    def __bool__(self) -> bool:
        return bool(self.luminaires or self.suns or self.sky is not None)

    @property
    def all(self) -> tuple[Luminaire | Sun | Sky, ...]:
        """All lights: luminaires, suns, then the sky."""
        return (*self.luminaires, *self.suns, *(() if self.sky is None else (self.sky,)))

    def digest(self) -> bytes:
        """Return a hash of everything that a solution depends on: not of where luminaire files lie. A web that many share is read
        once."""
        digest = hashlib.sha256()
        _update(digest, self, {})
        return digest.digest()


def _update(digest, value, webs: dict[int, bytes]) -> None:
    """Add a value to a hash: dataclasses field by field, arrays with their shapes.

    Args:
        webs: hashes of webs so far, by identity.
    """
    if isinstance(value, Web):
        if id(value) not in webs:
            own = hashlib.sha256()
            for one in fields(value):
                _update(own, getattr(value, one.name), webs)
            webs[id(value)] = own.digest()
        digest.update(webs[id(value)])
    elif is_dataclass(value):
        digest.update(type(value).__name__.encode())
        for one in fields(value):
            if one.name != "source":
                _update(digest, getattr(value, one.name), webs)
    elif isinstance(value, tuple):
        digest.update(str(len(value)).encode())
        for one in value:
            _update(digest, one, webs)
    elif isinstance(value, np.ndarray):
        digest.update(str((value.dtype.str, value.shape)).encode())
        digest.update(np.ascontiguousarray(value).tobytes())
    else:
        digest.update(repr(value).encode())
