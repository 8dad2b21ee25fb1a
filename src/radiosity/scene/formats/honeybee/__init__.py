"""Read honeybee models (HBJSON): rooms with windows and doors, and shades, with the modifiers of honeybee-radiance.

A surface is called by its kind and identifier: ``wall/office_north``, ``aperture/office_north_window``. Kinds are wall, floor,
ceiling, aperture, door and shade. All have two sides; fronts of rooms' faces look into the room. Of the two faces between
adjacent rooms the first is taken, and has the second one's reflectance on the side of its room. What `save_scene` wrote keeps the
names of its surfaces.
"""

import json
from pathlib import Path

from ....errors import SceneError
from ...assemble import assemble
from ...model import Scene
from ...parts import ReadOptions

NAME_KEY = "radiosity"  # of ``user_data``: the name of the surface that an object was


def read(path: Path, options: ReadOptions) -> Scene:
    """Read an .hbjson file.

    Raises:
        SceneError: it is no JSON or no honeybee model, or holds no faces.
    """
    from .reader import Reader
    from .schema import checked

    try:
        values = json.loads(path.read_bytes().decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise SceneError(f"{path}: is no JSON ({error}); honeybee's Model.to_hbjson writes it") from None
    model = checked(values, str(path))
    reader = Reader(str(path), model)
    reader.follow(model)
    reader.warn(options.strict)
    return assemble(reader.parts, str(path), options)
