"""Sensors: points at which light is measured."""

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from ..errors import SceneError, shown
from ..scene.model import Scene
from ..scene.sensor_table import UP, read
from .grid import grid
from .limits import LARGEST

KINDS = ("plane", "cylindrical")


@dataclass(frozen=True, eq=False)
class Sensors:
    """Points, and the direction that each looks in. Build them with `Sensors.grid`, `Sensors.of` or `Sensors.from_csv`.

    Attributes:
        points: (n, 3) float64, m.
        normals: (n, 3) float64, unit normals of the planes that light falls on; of cylindrical sensors the axis.
        set: (n,) int64, index into ``names``.
        names: of sets of sensors, such as grids.
        cells: (n, 2) int64, row and column of sensors of grids; -1 for others.
        cylindrical: (n,) bool: the mean over all planes that contain the axis is measured.
        spacings: for each set, how far apart its points are along columns and rows, m; NaN where it is no grid.

    Example:
        >>> room = rd.load_scene("room")
        >>> plane = rd.Sensors.grid(room, "floor", height=0.8, spacing=1.0, margin=0.5)
        >>> eyes = rd.Sensors.of([[3, 2, 1.2], [1, 1, 1.2]], kind="cylindrical", name="eyes")
        >>> len(plane + eyes), (plane + eyes).names
        (17, ('floor', 'eyes'))
    """

    points: np.ndarray
    normals: np.ndarray
    set: np.ndarray
    names: tuple[str, ...]
    cells: np.ndarray
    cylindrical: np.ndarray
    spacings: np.ndarray = field(default_factory=lambda: np.full((1, 2), np.nan))

    def __len__(self) -> int:
        return len(self.points)

    @staticmethod
    def of(points: ArrayLike, normals: ArrayLike = UP, *, name: str = "sensors", kind: str = "plane") -> "Sensors":
        """Make sensors from points.

        Args:
            points: (n, 3) m.
            normals: (n, 3), or one for all: where the planes look, of any length; of cylindrical sensors the axis.
            name: of the set.
            kind: "plane", or "cylindrical": the mean of the planes that contain the axis, as on a small upright cylinder.

        Raises:
            SceneError: a shape or value that makes no sense; it names the sensor.
        """
        points = np.array(points, float)
        if points.ndim == 1 and len(points) == 3:
            points = points[None]
        if points.ndim != 2 or points.shape[1] != 3 or not len(points):
            raise SceneError(f"sensors '{name}': points have the shape {points.shape}; it must be (n, 3), with one point or more")
        try:
            normals = np.array(np.broadcast_to(np.array(normals, float), points.shape))
        except ValueError:
            raise SceneError(f"sensors '{name}': there are {len(points)} points and {len(np.array(normals))} normals") from None
        if kind not in KINDS:
            raise SceneError(f"sensors '{name}': kind '{kind}' does not exist; known are {', '.join(KINDS)}")
        length = np.linalg.norm(normals, axis=1)
        for wrong, what, values in (
            (~(np.abs(points) < LARGEST).all(axis=1), f"its point must be numbers below {LARGEST:g} m", points),
            (~((length > 1e-12) & (length < np.inf)), "its normal has no direction", normals),
        ):
            if wrong.any():
                number = int(np.argmax(wrong))
                raise SceneError(f"sensors '{name}', sensor {number}: {values[number].tolist()}; {what}")
        n = len(points)
        every, none = np.full(n, kind == "cylindrical"), np.full((n, 2), -1)
        return Sensors(points, normals / length[:, None], np.zeros(n, np.int64), (name,), none, every)

    @staticmethod
    def grid(
        scene: Scene,
        surface: str,
        height: float = 0.0,
        spacing: float | None = None,
        *,
        margin: float = 0.0,
        name: str | None = None,
        direction: ArrayLike | None = None,
        kind: str = "plane",
    ) -> "Sensors":
        """Make a grid of sensors on a plane in front of a surface. It follows the surface's outline.

        Args:
            scene: that has the surface.
            surface: its name, or a pattern. Where its faces lie in several planes, the plane with the largest area is taken.
            height: m, of the plane above the surface, along the surface's normal. Faces that radiate on both sides count from
                the side that looks up.
            spacing: m, how far apart sensors are at most; by default as EN 12464-1 says: p = 0.2 * 5^(log10 d).
            margin: m, how far sensors stay away from the outline.
            name: of the set; that of the surface by default.
            direction: (3,) where the sensors' planes look; the surface's normal by default.
            kind: "plane" or "cylindrical", see `Sensors.of`.

        Raises:
            SceneError: no such surface, no sensor within its outline, or more than a million.
        """
        found = grid(scene, surface, height, spacing, margin)
        made = Sensors.of(found.points, found.normal if direction is None else direction, name=name or surface, kind=kind)
        return replace(made, cells=found.cells, spacings=found.steps[None])

    @staticmethod
    def from_csv(path, *, name: str | None = None, kind: str = "plane", normal: ArrayLike = UP) -> "Sensors":
        """Read sensors from a table with the columns x, y, z in m, and nx, ny, nz and name where it has them.

        A table without a head has x, y, z, or x, y, z, nx, ny, nz (as Radiance's points). Sensors of one name are one set.

        Args:
            path: the file; its values are separated by commas, semicolons, tabs or spaces.
            name: of sensors that have none; the file's name by default.
            kind: "plane" or "cylindrical", see `Sensors.of`.
            normal: (3,) of sensors whose table has none.

        Raises:
            SceneError: a file that cannot be read, a column that is missing, or a value that is no number; it names the line.
        """
        sets = [
            Sensors.of(points, normals, name=one, kind=kind)
            for one, points, normals in read(path, name, np.asarray(normal, float))
        ]
        return sum(sets[1:], sets[0])

    @staticmethod
    def of_scene(scene: Scene) -> "Sensors":
        """Make the sensors that the scene's file asks for: the `[[sensors]]` of a .toml.

        Raises:
            SceneError: it asks for none, or for a grid that makes no sense.
        """
        sets = []
        for one in scene.sensors:
            if one.surface is None:
                sets.append(Sensors.of(one.points, one.normals, name=one.name, kind=one.kind))
                continue
            sizes = {"height": one.height, "spacing": one.spacing, "margin": one.margin}
            sets.append(Sensors.grid(scene, one.surface, **sizes, name=one.name, direction=one.direction, kind=one.kind))
        if not sets:
            raise SceneError(f"{scene.source}: asks for no sensors; give a grid or points, or write [[sensors]] in a .toml scene")
        return sum(sets[1:], sets[0])

    def __add__(self, other: "Sensors") -> "Sensors":
        """Put sets of sensors side by side.

        Raises:
            SceneError: a name stands for two sets.
        """
        if both := {*self.names} & {*other.names}:
            raise SceneError(f"two sets of sensors are called {shown(sorted(both))}; give them names of their own")
        return Sensors(
            np.concatenate([self.points, other.points]),
            np.concatenate([self.normals, other.normals]),
            np.concatenate([self.set, other.set + len(self.names)]),
            self.names + other.names,
            np.concatenate([self.cells, other.cells]),
            np.concatenate([self.cylindrical, other.cylindrical]),
            np.concatenate([self.spacings, other.spacings]),
        )

    def named(self, name: str) -> "Sensors":
        """Return one set under another name."""
        return replace(self, names=(name,) * len(self.names))
