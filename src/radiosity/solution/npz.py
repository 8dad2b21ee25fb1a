"""The keys of a solution file, an NPZ archive that stands alone: scene, results, provenance and the state of the run.

An array of the scene has the key ``scene_NAME``, of a paint ``reflectance_paint_NAME``, of the state ``state_NAME``. The rest is
one text of JSON, ``meta``. Line sets are such files, too, with the same keys of scene and patches.
"""

SOLUTION, LINES, EXCHANGE, FACTORS = "solution", "line set", "radiative exchange", "view factors"  # kinds of files
READERS = {SOLUTION: "load_solution", LINES: "load_lines", EXCHANGE: "load_exchange", FACTORS: "load_view_factors"}
# of solutions; the second where patches have values of their own, the third where there are lights without area: older versions
# do not know these
FORMAT, FORMAT_OF_OWN, FORMAT_OF_LIGHTS = 1, 2, 3
FORMAT_OF_PANES = 4  # of all kinds of files, where the scene has panes, which older versions would take for opaque faces
PANES = "scene_transmittance"
FORMAT_OF_DIFFUSERS = 5  # of all kinds of files, where panes diffuse light
FORMAT_OF_GLASS, GLASS = 6, "scene_refractive_index"  # of all kinds of files, where panes have an index of refraction
FORMATS_OF_PANES = (FORMAT_OF_PANES, FORMAT_OF_DIFFUSERS, FORMAT_OF_GLASS)
DIFFUSERS = "scene_diffuse_transmittance"
OWN_ARRAYS = ("own_reflectance", "own_emission")  # of patches, that may be missing
SCENE_ARRAYS = (
    "vertices",
    "faces",
    "reflectance",
    "emission",
    "back",
    "back_reflectance",
    "back_emission",
    "surface",
    "patch_size",
)
CUT_ARRAYS = ("face", "region")  # of scenes whose faces are parts of other faces
PAINT_ARRAYS = ("image", "uv", "color")
SOLUTION_ARRAYS = ("irradiance", "irradiance_standard_error", "arrivals")
POWER_ARRAYS = ("surface_power", "side_power", "side_bias")  # arrays that may be missing
WARNINGS = "warnings"  # a list of texts, which may be missing
BASIS_ARRAYS = ("irradiance_coefficients", "irradiance_coefficients_standard_error")  # only of bases of several functions
SCALARS = ("rays", "seconds", "quanta", "replicates", "books", "status", "provenance")
