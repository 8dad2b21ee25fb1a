"""Named algorithms that iterate."""

from ..model import Method
from .model import Preset

ITERATIONS = {
    "stochastic-ray": Preset(
        Method(order="regular"),
        "Each iteration sends all power anew by a modest set of lines, drawn in proportion to power; iterates are averaged "
        "by their lines.",
        "To compare; early iterates are remembered, which costs accuracy at few lines.",
        "neumann1995ray",
        ("control_variate", "refine_lines"),
    ),
    "stochastic-jacobi": Preset(
        Method(order="regular", warm_up=True),
        "Stochastic Jacobi radiosity: incremental iterations first, then regular ones that are averaged.",
        "The iterative method to take; the first iterate is complete and nearly unbiased.",
        "bekaert1999",
        ("control_variate", "estimator", "refine_lines"),
    ),
    "stochastic-jacobi-incremental": Preset(
        Method(order="incremental"),
        "Iterations send only the power not sent yet, with ever fewer lines of about equal power.",
        "Unbiased and simple; close to shirley, with powers of lines that vary.",
        "bekaert1999",
        ("control_variate", "estimator", "refine_lines"),
    ),
    "stochastic-jacobi-bidirectional": Preset(
        Method(order="regular", warm_up=True, estimator="bidirectional"),
        "Both ends of every line exchange power, each weighted by its share of the density that the line was drawn with.",
        "Where many patches are about as bright as each other.",
        "bekaert1999",
        ("control_variate", "refine_lines"),
    ),
    "stochastic-jacobi-control-variate": Preset(
        Method(order="regular", warm_up=True, control_variate=True),
        "A constant radiosity is taken out of what the lines carry and put back exactly, so that lines only carry what differs.",
        "Rooms, together with estimator bidirectional: less error at equal lines than random-walk, but no exact books.",
        "bekaert1999",
        ("estimator", "refine_lines"),
    ),
}
