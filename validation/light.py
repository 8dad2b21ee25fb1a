"""Referee of light at points: Radiance's rtrace in three rooms, two lit by lamps and one by an overcast sky.

The rooms are 5 x 4 x 3 m and reflect half of the light. Lamps are spheres of a centimetre in Radiance, whose radiance gives the
intensity of ours; the sky is a glow of 1 + 2 sin h. `rtrace` traces single paths, with the options of `validation/rtrace.py`.
Sensors are a grid of 1 m at 0.85 m.
"""

import numpy as np

import radiosity as rd
from radiosity.scene.shapes import box, join, quad

from .comparison import Value
from .radiance_file import text
from .rtrace import traced
from .runs import SEEDS

RADIUS = 0.01  # m, of a lamp in Radiance
SKY = """
void brightfunc overcast 2 "if(Dz,1+2*Dz,0)" . 0 0
overcast glow sky 0 0 4 1 1 1 0
sky source dome 0 0 4 0 0 1 360
"""
WALLS = ("walls", 0.5, 0.0)
POINTS = np.array([[x, y, 0.85] for y in (0.5, 1.5, 2.5, 3.5) for x in (0.5, 1.5, 2.5, 3.5, 4.5)])


def lamps(*places, intensity: float = 100.0) -> tuple[list, str]:
    """Lamps alike in all directions: ours, and Radiance's."""
    ours = [rd.point_light(position=place, intensity=intensity) for place in places]
    radiance = intensity / (np.pi * RADIUS**2)
    spheres = [f"lamp sphere l{i} 0 0 4 {x} {y} {z} {RADIUS}" for i, (x, y, z) in enumerate(places)]
    return ours, "\n".join([f"void light lamp 0 0 3 {radiance} {radiance} {radiance}", *spheres, ""])


def rooms():
    """Yield the name, our scene, and what Radiance has besides its surfaces."""
    walls = box((0, 0, 0), (5, 4, 3), inward=True)
    ours, theirs = lamps((1.5, 2, 2.5), (3.5, 1.2, 2.2))
    yield "two globes", join([(*WALLS, walls)], source="globes").with_lights(ours), theirs
    table = box((2, 1.2, 0.0), (3, 2.8, 1.4))
    ours, theirs = lamps((2.2, 2, 2.6))
    yield "a globe above a box", join([(*WALLS, walls), ("box", 0.5, 0.0, table)], source="box").with_lights(ours), theirs
    low, high = (2.0, 0.0, 1.0), (3.0, 0.0, 2.0)
    around = [((0, 0, 0), (5, 0, 0), (0, 0, 1)), ((0, 0, 2), (5, 0, 0), (0, 0, 1))]
    around += [((0, 0, 1), (2, 0, 0), (0, 0, 1)), ((3, 0, 1), (2, 0, 0), (0, 0, 1))]
    faces = [face for face in walls if np.ptp(face[:, 1]) > 0 or face[0, 1] > 0]
    faces += [quad(*one)[::-1] for one in around]
    horizontal = 7 * np.pi / 3  # of 1 + 2 sin h
    window = quad(low, (1, 0, 0), (0, 0, high[2] - low[2]))
    scene = join([(*WALLS, faces)], source="window")
    yield "a window of 1 m²", scene.with_lights(sky=rd.cie_sky("overcast", horizontal), openings=[window]), SKY


def theirs(scene: rd.Scene, more: str, points: np.ndarray, paths: int) -> np.ndarray:
    """(SEEDS, n) irradiances at points that look up."""
    dark = text(scene)
    rays = np.concatenate([points, np.tile([0, 0, 1.0], (len(points), 1))], axis=1)
    many = np.tile(rays, (SEEDS * paths, 1))
    return traced(dark + more, many)[:, 0].astype(float).reshape(SEEDS, paths, len(points)).mean(axis=1)


def run(quick: bool):
    """The mean over sensors, and the sensor that differs most, of each room."""
    paths, lines = (200, 200_000) if quick else (4000, 2_000_000)
    for name, scene, more in rooms():
        points = POINTS if "box" not in name else POINTS[(np.abs(POINTS[:, 0] - 2.5) > 0.6) | (np.abs(POINTS[:, 1] - 2) > 0.9)]
        radiance = theirs(scene, more, points, paths)
        patches = rd.subdivide(scene, size=0.25)
        sensors = rd.Sensors.of(points)
        ours = np.array(
            [rd.measure(patches, sensors, rays=lines, replicates=2, seed=seed).illuminance[:, 0] for seed in range(SEEDS)]
        )
        yield _value(f"{name}: mean", ours.mean(axis=1), radiance.mean(axis=1))
        off = (ours.mean(axis=0) - radiance.mean(axis=0)) / np.hypot(ours.std(axis=0), radiance.std(axis=0))
        worst = int(np.argmax(np.abs(off)))
        yield _value(f"{name}: sensor at {points[worst].tolist()}", ours[:, worst], radiance[:, worst], len(points))


def _value(name: str, ours: np.ndarray, radiance: np.ndarray, of: int = 1) -> Value:
    """A comparison of two measured numbers; the worst of ``of`` has a bound for that choice."""
    errors = [values.std(ddof=1) / np.sqrt(len(values)) for values in (ours, radiance)]
    note = f"rtrace ± {errors[1]:.1e}" + (f", the worst of {of}" if of > 1 else "")
    error = float(np.hypot(*errors))
    return Value(name, float(radiance.mean()), float(ours.mean()), error, SEEDS, note, 2 * error if of > 1 else 0.0)
