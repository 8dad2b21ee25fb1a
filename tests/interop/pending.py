"""What the generators leave out until our readers have it. Delete this file when both are True."""

TEXTURES = False  # wraps, filters and means that do not depend on the patch size; PLY textures that vary
FORMATS = False  # glTF instances
