"""Named methods that form the matrix."""

from ..baseline import Baseline
from .model import Preset

BASELINES = {
    "full-matrix": Preset(
        Baseline("full-matrix"),
        "All form factors first: exact ones of polygons times the share that sees each other, from hemicubes, or from local "
        "lines; then the equation is solved. Memory and time grow with the square of the number of patches.",
        "Small scenes as an oracle; scenes whose emission or reflectance changes often.",
        "goral1984",
        (
            "factors",
            "resolution",
            "rotated",
            "samples",
            "solver",
            "reciprocal",
        ),
    ),
    "full-matrix-hemicube": Preset(
        Baseline("full-matrix", factors="hemicube"),
        "The same with hemicubes, as radiosity programs of their time had it: only the middle of a patch looks at the scene.",
        "To compare; near and small things alias, docs/baselines.md shows how much.",
        "cohen1985",
        (
            "factors",
            "resolution",
            "rotated",
            "solver",
            "reciprocal",
        ),
    ),
    "progressive-refinement": Preset(
        Baseline("progressive", factors="hemicube"),
        "The patch with the most unshot power shoots it to all others along a row of form factors made for it; then the next. "
        "The matrix is never kept.",
        "To compare; a first picture after few shots. With ambient, it is as bright as the last one from the start.",
        "cohen1988",
        (
            "factors",
            "resolution",
            "rotated",
            "samples",
            "ambient",
            "overshooting",
        ),
    ),
    "hierarchical": Preset(
        Baseline("hierarchical"),
        "Faces are cut into quadtrees of elements, and links join elements as large as their exchange allows: light is gathered "
        "over links, pushed down to the patches and pulled up again.",
        "Few large faces: it keeps some links for each patch, not one for each pair. First more samples, then a smaller epsilon.",
        "hanrahan1991",
        (
            "epsilon",
            "samples",
            "refinement",
        ),
    ),
    "hierarchical-error-control": Preset(
        Baseline("hierarchical", refinement="error-radiance"),
        "The same, but a link is cut where an estimate of its error says so, from how much the kernel varies over the link.",
        "As hierarchical, where shadows and contacts need finer links and smooth exchange coarser ones.",
        "bekaert1996",
        (
            "epsilon",
            "samples",
            "refinement",
        ),
    ),
}
