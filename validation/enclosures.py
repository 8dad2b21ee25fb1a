"""Referee: closed rooms whose solution is known. Emission is emissivity times what a black body would emit, W/m²."""

import numpy as np

import radiosity as rd

from .closed_forms import enclosures as exact
from .closed_forms import rectangles
from .comparison import Patchwise, Value, patchwise
from .runs import SEEDS, Runs, solved
from .shapes import Facets, ball, quad, scene, turned

RANDOM = rd.Method(numbers="random")
EMISSIVITY, BLACKBODY = (0.6, 0.3), (10.0, 2.0)


def _grey(name: str, emissivity: float, blackbody: float, facets: Facets):
    return name, 1 - emissivity, emissivity * blackbody, facets


def concentric_spheres(rays: float) -> Value:
    """Radii 1 and 1.8, both grey; of facets, so that the outer one's radiosity is not quite uniform: extrapolated."""
    net = []
    for level in (2, 3):
        inner, outer = ball(1.0, level), turned(ball(1.8, level))
        cut = rd.subdivide(
            scene(
                *(_grey(n, e, b, f) for n, e, b, f in zip(("inner", "outer"), EMISSIVITY, BLACKBODY, (inner, outer), strict=True))
            ),
            cells=1,
        )
        net.append(solved(cut, rays, method=RANDOM, first=100 * level).net(0))
    value = exact.two_spheres(1.0, 1.8, EMISSIVITY, BLACKBODY)
    note = f"facets: {(net[1].mean() - net[0].mean()) / 3 / value:+.2%} at the finer mesh, extrapolated"
    return Value.of("concentric grey spheres, W exchanged", value, net[1] + (net[1] - net[0]) / 3, note)


def sphere_with_a_hot_cap(rays: float) -> Value:
    """A closed sphere of reflectance 0.7, a quarter of which emits: its irradiance is the same everywhere, here opposite."""
    means = []
    for level in (2, 3):
        wall = turned(ball(1.0, level))
        hot = [f[:, 2].mean() > 0.5 for f in wall]
        parts = [
            ("hot", 0.7, 3.0, [f for f, h in zip(wall, hot, strict=True) if h]),
            ("cold", 0.7, 0.0, [f for f, h in zip(wall, hot, strict=True) if not h]),
        ]
        patches = rd.subdivide(scene(*parts), cells=1)
        share = patches.area[patches.surface == 0].sum() / patches.area.sum()
        exactly = 3.0 * share / (1 - 0.7)
        far = patches.centroid[:, 2] < -0.5
        means.append(solved(patches, rays, method=RANDOM, first=100 * level).mean(far) / exactly)
    note = f"facets: {(means[1].mean() - means[0].mean()) / 3:+.2%} at the finer mesh, extrapolated"
    return Value.of("sphere with a hot cap, irradiance opposite over exact", 1.0, means[1] + (means[1] - means[0]) / 3, note)


def spherical_cavity(rays: float) -> Value:
    """A sphere without a cap, reflectance 0.6: W that leave through the opening."""
    ratios = []
    for level in (2, 3):
        facets = [f for f in turned(ball(1.0, level)) if f[:, 2].mean() < 0.6]
        patches = rd.subdivide(scene(("wall", 0.6, 1.0, facets)), cells=1)
        value = exact.spherical_cavity(patches.area.sum() / (4 * np.pi), 0.6, 1.0)
        # what leaves is what was emitted less what is absorbed
        ratios.append(solved(patches, rays, method=RANDOM, first=100 * level).net(0) / value)
    note = f"facets: {(ratios[1].mean() - ratios[0].mean()) / 3:+.2%} at the finer mesh, extrapolated"
    return Value.of("spherical cavity, W through its opening over exact", 1.0, ratios[1] + (ratios[1] - ratios[0]) / 3, note)


def box(rays: float) -> list[Value]:
    """A box of 2 x 1 x 0.7 m, six grey walls, one patch each: the equation of the patches has the exact matrix."""
    x, y, z = sides = (2.0, 1.0, 0.7)
    walls = [
        quad((0, 0, 0), (0, y, 0), (0, 0, z)),
        quad((x, 0, 0), (0, 0, z), (0, y, 0)),
        quad((0, 0, 0), (0, 0, z), (x, 0, 0)),
        quad((0, y, 0), (x, 0, 0), (0, 0, z)),
        quad((0, 0, 0), (x, 0, 0), (0, y, 0)),
        quad((0, 0, z), (0, y, 0), (x, 0, 0)),
    ]
    emissivity, blackbody = (0.9, 0.5, 0.2, 0.7, 0.4, 0.8), (1.0, 6.0, 3.0, 0.0, 8.0, 2.0)
    names = ("x low", "x high", "y low", "y high", "z low", "z high")
    areas, factors = exact.box_factors(sides, rectangles.parallel, rectangles.perpendicular)
    wanted = exact.net(areas, factors, emissivity, blackbody)
    parts = [_grey(n, e, b, [w]) for n, e, b, w in zip(names, emissivity, blackbody, walls, strict=True)]
    runs = solved(rd.subdivide(scene(*parts), cells=1), rays)
    return [_lost(f"six grey walls, W lost by '{name}'", wanted[i], runs, i) for i, name in enumerate(names)]


def duct(rays: float) -> list[Value]:
    """A triangular duct of sides 3, 4 and 5, six long, three grey walls at three temperatures and two black ends."""
    a, b, length = 3.0, 4.0, 6.0
    areas, factors = exact.prism_factors(np.pi / 2, (a, b), length, rectangles.inclined)
    emissivity, blackbody = (0.8, 0.3, 0.5, 1.0, 1.0), (9.0, 1.0, 4.0, 0.0, 0.0)
    wanted = exact.net(areas, factors, emissivity, blackbody)
    ends = np.array([(0, 0, 0), (a, 0, 0), (0, 0, b)])
    facets = [
        quad((0, 0, 0), (a, 0, 0), (0, length, 0)),
        quad((0, 0, b), (0, 0, -b), (0, length, 0)),
        quad((a, 0, 0), (-a, 0, b), (0, length, 0)),
        ends[::-1],
        ends + np.array([0, length, 0]),
    ]
    names = ("side of 3", "side of 4", "side of 5", "near end", "far end")
    parts = [_grey(n, e, m, [f]) for n, e, m, f in zip(names, emissivity, blackbody, facets, strict=True)]
    runs = solved(rd.subdivide(scene(*parts), cells=1), rays)
    return [_lost(f"triangular duct, W lost by '{name}'", wanted[i], runs, i) for i, name in enumerate(names)]


def _lost(name: str, wanted: float, runs: Runs, surface: int) -> Value:
    return Value.of(name, wanted, runs.net(surface), bound=runs.rounding * runs.absorbed(surface))


def deep_box(rays: float) -> Value:
    """Plates 5000 times as wide as their distance, the flux in the middle against infinite ones."""
    half, cells = 2500.0, 5
    plates = [
        quad((-half, -half, 0), (2 * half, 0, 0), (0, 2 * half, 0)),
        quad((-half, -half, 1), (0, 2 * half, 0), (2 * half, 0, 0)),
    ]
    parts = [_grey(n, e, b, [p]) for n, e, b, p in zip(("floor", "ceiling"), EMISSIVITY, BLACKBODY, plates, strict=True)]
    patches = rd.subdivide(scene(*parts), cells=cells)
    middle = (np.abs(patches.centroid[:, :2]).max(axis=1) < 500) & (patches.surface == 0)
    runs = solved(patches, rays)
    flux = patches.emission[middle][0, 0] - (1 - patches.reflectance[middle][0, 0]) * runs.mean(middle)
    # a line goes 2000 m, from the middle patch to the edge, in one step with a share below 1 / 2000²; of a walk of n steps one is
    # at least 2000 / n long: the sum over n of n (n / 2000)² rho^n
    rho = np.sqrt(0.4 * 0.7)
    steps = np.arange(1, 200)
    bound = float((steps**3 * rho**steps).sum() / 2000**2 * max(BLACKBODY))
    bound += runs.rounding * float(patches.emission[middle][0, 0])
    return Value.of("infinite parallel plates, W/m²", exact.parallel_plates(EMISSIVITY, BLACKBODY), flux, bound=bound)


def labyrinth(rays: float) -> Patchwise:
    """The built-in furnace of mean reflectance 0.9, every patch: radiosity and irradiance are one."""
    patches = rd.subdivide(rd.load_scene("labyrinth-0.9"), cells=1)
    runs = solved(patches, rays, replicates=4)
    exactly = np.ones((len(patches), 1))
    return patchwise("labyrinth-0.9, random-walk", runs, exactly)


def run(quick: bool):
    """Values and patchwise comparisons."""
    rays = (100_000 if quick else 1_000_000) * SEEDS
    yield concentric_spheres(rays)
    yield sphere_with_a_hot_cap(rays)
    yield spherical_cavity(rays)
    yield from box(rays)
    yield from duct(rays)
    yield deep_box(rays)
    yield labyrinth(rays)
