"""What the generators leave out where our readers do not have it yet."""

from importlib.util import find_spec

# wraps, filters, mesh attributes, -clamp, and means that do not depend on the patch size
TEXTURES = find_spec("radiosity.scene.sampler") is not None
