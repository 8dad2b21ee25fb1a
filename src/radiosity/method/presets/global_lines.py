"""Named algorithms of lines through the whole scene."""

from ..model import Method
from .model import Preset

GLOBAL = {
    "transillumination": Preset(
        Method(lines="bundles", order="regular"),
        "A direction at a time, the whole scene exchanges light along a bundle of parallel lines; what each patch met is "
        "pooled over all directions. Certain about the attribution is only that L. Neumann's Monte Carlo radiosity (1995) "
        "never forms form factors, as the comparison of Bekaert, Cools and Willems says; that it is this method of parallel "
        "lines is from memory.",
        "Large lights and evenly lit rooms; small lights need a first shot.",
        "neumann1995",
        ("first_shot", "lines"),
    ),
    "global-multipath": Preset(
        Method(lines="global", order="multipath"),
        "Lines through the scene, each span an exchange between two patches in both directions: power that one line leaves "
        "on a patch goes on with the next line through it.",
        "Scenes where emission is spread over most of the area.",
        "sbert1996",
        ("lines",),
    ),
    "global-multipath-first-shot": Preset(
        Method(lines="global", order="multipath", first_shot=0.25),
        "Global multipath after the lights' own power was sent by local lines, a quarter of all.",
        "Global lines in scenes with small lights.",
        "sbert1996",
        ("first_shot", "lines"),
    ),
    "global-form-factors": Preset(
        Method(lines="global", order="matrix"),
        "Counts of spans between patches give form factors by integral geometry; the equation is solved with them.",
        "Small scenes whose emission or reflectance is to be changed later. Memory grows with pairs of patches.",
        "sbert1993",
        ("lines",),
    ),
}
