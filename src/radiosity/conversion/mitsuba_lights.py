"""Lights without area as emitters of Mitsuba: points, spots that weaken in proportion to the angle, suns, an even sky."""

from collections.abc import Iterator
from xml.sax.saxutils import quoteattr

from ..scene.lights.model import Lights
from . import webs
from .mitsuba_tags import numbers, rgb, transform
from .told import Told


def lights_of(lights: Lights, taken: set[str], told: Told) -> Iterator[str]:
    """Yield an emitter for each light.

    Args:
        taken: names of shapes; a light of such a name has none.
    """
    names = taken.copy()

    def emitter(kind: str, name: str, inside: str) -> str:
        usable = name not in names and not set(name) & {".", "$"} and name.isprintable() and not name.startswith("_")
        names.add(name)
        return f'  <emitter type="{kind}"{f" id={quoteattr(name)}" if usable and name else ""}>{inside}</emitter>'

    for lamp in lights.luminaires:
        intensity = rgb("intensity", lamp.power / lamp.web.flux * lamp.web.intensity.max())
        angles = None if webs.uniform(lamp) else webs.linear_cone(lamp)
        if webs.uniform(lamp):
            yield emitter("point", lamp.name, f'<point name="position" value="{numbers(lamp.position)}"/>{intensity}')
        elif angles is not None:
            shape = "".join(
                f'<float name="{key}" value="{angle!r}"/>'
                for key, angle in zip(("beam_width", "cutoff_angle"), angles, strict=True)
            )
            turned = transform(lamp.position, lamp.axes[2], lamp.axes[0])
            yield emitter("spot", lamp.name, shape + turned + intensity)
        else:
            told.add("luminaires whose webs are no points or spots of Mitsuba are left out", [lamp.name])
            continue
        if lamp.group:
            told.add("groups of luminaires are left out", [lamp.group])
    for sun in lights.suns:
        if sun.diameter:
            told.add("suns lose their disc, so that their shadows are sharp", [sun.name])
        way = f'<vector name="direction" value="{numbers(-sun.direction)}"/>'
        yield emitter("directional", sun.name, way + rgb("irradiance", sun.irradiance))
    sky = lights.sky
    if sky is not None and (sky.radiance == sky.radiance[0, 0]).all():
        yield emitter("constant", sky.name, rgb("radiance", sky.radiance[0, 0]))
    elif sky is not None:
        told.add("skies that are not the same in all directions are left out", [sky.name])
