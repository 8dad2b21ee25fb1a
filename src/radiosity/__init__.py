"""Radiosity by tracing lines: B = E + rho F B, without ever forming F.

scene file -> Scene -> Patches -> [ numbers -> lines -> hits -> tally ] -> Solution -> files, pictures

scene = load_scene("room.mgf")               # or Scene.from_arrays(...)
patches = subdivide(scene, size=0.10)        # or cells=k, or leave it to solve
solution = solve(patches, rays=10_000_000)   # radiosity and its standard error, per patch and band
solution.export("room.glb")
"""

from importlib import import_module
from typing import TYPE_CHECKING

from .device import llvm
from .errors import DeviceError, MethodError, OutputError, RadiosityError, RadiosityWarning, SceneError
from .hooks import HOOKS

if TYPE_CHECKING:
    __version__: str

    from .comparison.compare import compare
    from .comparison.result import Comparison
    from .conversion.save import save_scene
    from .diagnostics.check import check
    from .exchange.compute import view_factors
    from .exchange.gebhart import GebhartFactors, gebhart_factors
    from .exchange.load_factors import load_view_factors
    from .exchange.loading import load_exchange
    from .exchange.radiative import radiative_exchange
    from .exchange.result import RadiativeExchange
    from .exchange.view_factors import ViewFactors
    from .image.projections import Orthographic, Panorama, plan
    from .lightmap.bake import bake_lightmap
    from .lightmap.model import Lightmap
    from .method import BASELINES, PRESETS, Baseline, Method
    from .patches import Patches, subdivide
    from .report_page.page import write_report
    from .run.adapt import adapt
    from .run.line_set.loading import load_lines
    from .run.line_set.model import LineSet
    from .run.line_set.trace import trace_lines
    from .run.merge import merge
    from .run.refine import refine_check
    from .run.solve import solve
    from .scene import Back, Camera, Scene, load_scene
    from .scene.lights.build import load_photometry, point_light, read_luminaire
    from .scene.lights.luminaire import Luminaire
    from .scene.lights.photometry import Photometry
    from .scene.lights.skies import cie_sky, uniform_sky
    from .scene.lights.sky import Sky
    from .scene.lights.sun import Sun, sun
    from .scene.lights.sun_position import sun_position
    from .scene.lights.weather import epw_sky, perez_sky
    from .sensors.annual.annual import annual
    from .sensors.annual.result import AnnualDaylight
    from .sensors.glare import GlareRating, unified_glare_rating
    from .sensors.measure import measure
    from .sensors.model import Sensors
    from .sensors.result import Measurement
    from .solution import RefineCheck, Solution, load_solution
    from .viewer.view import Viewer, view

llvm.point()  # before anything imports Dr.Jit, which loads libLLVM at once


def _export(solution, path, **options) -> None:
    from .image import export

    export(solution, path, **options)


def _gather(*of, **options):
    from .sensors.pixels import Gather

    return Gather.of(*of, **options)


def _sight(*of):
    from .sensors.sight import sight

    return sight(*of)


def _adapt(*of, **options):
    from .run.adapt import adapt

    return adapt(*of, **options)


def _cut_at_contacts(patches):
    from .patches.contact import cut_at_contacts

    return cut_at_contacts(patches.scene, len(patches), max(len(patches) // 8, 64), patches.sizes)


def _on_cluster(*of):
    from .cluster.solve import solve

    return solve(*of)


def _connected(*of):
    from .cluster.connect import connected

    return connected(*of)


def _sensing(*of):
    from .cluster.sensing import sensing

    return sensing(*of)


def _years(*of):
    from .cluster.years import years

    return years(*of)


HOOKS["export"] = _export  # of `Solution.export`
HOOKS["adapt"] = _adapt  # of `subdivide(scene, patches=...)` and `solve(scene, adaptive=True)`
HOOKS["cut at contacts"] = _cut_at_contacts  # of `subdivide(scene, contacts=True)`
HOOKS["gather"] = _gather  # of pictures with a final gather
HOOKS["sight"] = _sight  # of `solve(scene, importance=...)`
HOOKS["cluster"] = _on_cluster  # of `solve(scene, cluster=...)`
HOOKS["connected"] = _connected  # of what solves and traces on one cluster
HOOKS["sensing"] = _sensing  # of `measure(scene, sensors, cluster=...)`
HOOKS["years"] = _years  # of `annual(scene, weather, cluster=...)`

# Loaded when first asked for: the command line then hears Ctrl-C before numpy and all the rest are imported.
_HOMES = {
    "comparison.compare": ("compare",),
    "comparison.result": ("Comparison",),
    "conversion.save": ("save_scene",),
    "diagnostics.check": ("check",),
    "exchange.compute": ("view_factors",),
    "exchange.gebhart": ("GebhartFactors", "gebhart_factors"),
    "exchange.load_factors": ("load_view_factors",),
    "exchange.loading": ("load_exchange",),
    "exchange.radiative": ("radiative_exchange",),
    "exchange.result": ("RadiativeExchange",),
    "exchange.view_factors": ("ViewFactors",),
    "image.projections": ("Orthographic", "Panorama", "plan"),
    "lightmap.bake": ("bake_lightmap",),
    "lightmap.model": ("Lightmap",),
    "method": ("BASELINES", "PRESETS", "Baseline", "Method"),
    "patches": ("Patches", "subdivide"),
    "run.adapt": ("adapt",),
    "report_page.page": ("write_report",),
    "run.line_set.loading": ("load_lines",),
    "run.line_set.model": ("LineSet",),
    "run.line_set.trace": ("trace_lines",),
    "run.merge": ("merge",),
    "run.refine": ("refine_check",),
    "run.solve": ("solve",),
    "scene": ("Back", "Camera", "Scene", "load_scene"),
    "scene.lights.build": ("load_photometry", "point_light", "read_luminaire"),
    "scene.lights.luminaire": ("Luminaire",),
    "scene.lights.photometry": ("Photometry",),
    "scene.lights.skies": ("cie_sky", "uniform_sky"),
    "scene.lights.sky": ("Sky",),
    "scene.lights.sun": ("Sun", "sun"),
    "scene.lights.sun_position": ("sun_position",),
    "scene.lights.weather": ("epw_sky", "perez_sky"),
    "sensors.annual.annual": ("annual",),
    "sensors.annual.result": ("AnnualDaylight",),
    "sensors.glare": ("GlareRating", "unified_glare_rating"),
    "sensors.measure": ("measure",),
    "sensors.model": ("Sensors",),
    "sensors.result": ("Measurement",),
    "solution": ("RefineCheck", "Solution", "load_solution"),
    "viewer.view": ("Viewer", "view"),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "BASELINES",
    "PRESETS",
    "AnnualDaylight",
    "Back",
    "Baseline",
    "Camera",
    "Comparison",
    "DeviceError",
    "GebhartFactors",
    "GlareRating",
    "Lightmap",
    "LineSet",
    "Luminaire",
    "Measurement",
    "Method",
    "MethodError",
    "Orthographic",
    "OutputError",
    "Panorama",
    "Patches",
    "Photometry",
    "RadiativeExchange",
    "RadiosityError",
    "RadiosityWarning",
    "RefineCheck",
    "Scene",
    "SceneError",
    "Sensors",
    "Sky",
    "Solution",
    "Sun",
    "ViewFactors",
    "Viewer",
    "adapt",
    "annual",
    "bake_lightmap",
    "check",
    "cie_sky",
    "compare",
    "epw_sky",
    "gebhart_factors",
    "load_exchange",
    "load_lines",
    "load_photometry",
    "load_scene",
    "load_solution",
    "load_view_factors",
    "measure",
    "merge",
    "perez_sky",
    "plan",
    "point_light",
    "radiative_exchange",
    "read_luminaire",
    "refine_check",
    "save_scene",
    "solve",
    "subdivide",
    "sun",
    "sun_position",
    "trace_lines",
    "unified_glare_rating",
    "uniform_sky",
    "view",
    "view_factors",
    "write_report",
]


def __getattr__(name: str):
    if name in _HOME:
        value = globals()[name] = getattr(import_module(f".{_HOME[name]}", __name__), name)
        return value
    if name == "__version__":
        return import_module("importlib.metadata").version(__name__)
    if name in _HOMES:
        return import_module(f".{name}", __name__)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
