"""Named algorithms of local lines and walks."""

from ..model import Method
from .model import Preset

WALKS = {
    "random-walk": Preset(
        Method(),
        "Discrete random walks: a particle leaves the patch that it hit from a fresh uniform point. Here the patches own "
        "the walk: each fires as many lines as its emission and its arrivals times reflectance make whole quanta, so that "
        "no number is drawn for absorption and the counts do not depend on the order of firing.",
        "The default: fast, little error at equal lines, exact books, and the same bits on any number of threads.",
        "sbert1997",
        ("estimator", "absorption", "coherent"),
    ),
    "gather": Preset(
        Method(order="gather"),
        "Every patch gathers: shadow rays to the lamps, and cosine lines that read the radiosity of the patches they hit. That "
        "radiosity is solved along the first lines of each patch, which are stored, and corrected by all lines. A pilot shares "
        "lines out to where they are needed.",
        "Rooms with some tens of lamps: a fifth to a tenth of the time of random-walk for the same error. No exact books.",
        "bekaert1999",
    ),
    "particle-tracing": Preset(
        Method(equation="continuous"),
        "Particles are followed from the lights and go on from the very point that they hit; patches only count. It solves "
        "the continuous equation: the result is the mean over each patch of the exact solution.",
        "Where patches are large: there is no discretisation error in the light itself. More noise than random-walk.",
        "pattanaik1992",
        ("estimator", "absorption"),
    ),
    "shirley": Preset(
        Method(order="breadth-first"),
        "Zonal shooting: pass k sends all light reflected k times, in lines of equal power. On the firing engine the lines, "
        "and every count, are those of random-walk.",
        "To have the direct light whole before the first reflection.",
        "shirley1991",
    ),
    "progressive-ray-refinement": Preset(
        Method(order="staged"),
        "Shirley's passes in stages of doubling numbers of lines, the first of a thousand, with a whole picture after each. "
        "Stages go on with the sample indices of those before, so that no line is traced twice and nothing is averaged.",
        "To see a rough solution at once and watch it get better.",
        "feda1993",
    ),
    "wdrs": Preset(
        Method(order="well-distributed"),
        "Well distributed ray sets: patch i is given as many lines as its power makes quanta; stage after stage halves the "
        "quantum, and patches fire what they lack. The first quantum is no larger than the power of the weakest light. The "
        "original lets powers of lines vary; ours are equal, so that counts are those of random-walk.",
        "To study it; the result is random-walk's to the bit at equal quanta.",
        "neumann1997",
    ),
    "qmc-radiosity": Preset(
        Method(equation="continuous", absorption="fractional"),
        "Keller's quasi-Monte Carlo radiosity: walk n takes point n of a sequence, its birth patch too, and of M walks the "
        "first M rho^k go on at the k-th hit with weights, rho being the mean reflectance. Later segments take "
        "the same sequence in other orders (Latin supercube sampling); his own rule, ever larger prime bases, is "
        "padding prime-bases. What the last walk leaves behind is cut off: a bias of the order of one walk.",
        "To compare; random-walk and particle-tracing have less error where reflectances differ much.",
        "keller1996",
        ("padding",),
    ),
    "density-estimation": Preset(
        Method(equation="continuous", reconstruction="local-linear"),
        "Particle tracing, then each surface is reconstructed alone: a plane is fitted to the hits about each point, "
        "weighted by a kernel whose width falls as lines grow. The fit takes away the bias at boundaries. Landings are "
        "binned to the patches first. Surfaces keep the power that they received, and stated errors hold what blurred "
        "shadows are off.",
        "For smooth pictures from few lines: 0.7 of the error of counting up to a hundred or so hits on a patch.",
        "walter1997",
    ),
}
