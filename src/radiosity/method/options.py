"""The table of the options of a method. `Method` and `Baseline` have a field for each entry, in this order, and its default.

Everything that tells or checks an option reads it here: docstrings, ``radiosity solve``, ``radiosity methods``, docs/methods.md.
"""

from ..sampling.numbers import NUMBERS
from .basis import BASES
from .equation import EQUATIONS
from .estimator import ABSORPTIONS, ESTIMATORS
from .lines import LINES
from .option import Option, table
from .order import ORDERS
from .padding import PADDINGS
from .randomisation import RANDOMISATIONS
from .reconstruction import RECONSTRUCTIONS
from .schemes import FACTORS, REFINEMENTS, SCHEMES, SOLVERS
from .scrambling import SCRAMBLINGS

AUTO = {"auto": "rounded where patches can round, else drawn"}

METHOD = table(
    Option(
        "equation",
        "Where a particle leaves the patch that it hit: discrete (a new point) or continuous (the same point).",
        values=EQUATIONS,
    ),
    Option("lines", "Line type: local, global, or another one that `radiosity methods lines` lists.", values=LINES),
    Option("order", "Which line is fired next; `radiosity methods order` lists the choices.", values=ORDERS),
    Option(
        "numbers",
        "Sequence of points that lines are made from; `radiosity methods numbers` lists the choices.",
        values=dict.fromkeys(NUMBERS, ""),  # their meanings are the docstrings of their modules
        details="Two are older names: generalized-faure is faure with scrambling linear, scrambled-halton is halton with "
        "scrambling permuted-digits.",
    ),
    Option(
        "scrambling",
        "How the sequence is scrambled: none, permuted-digits (halton) or linear (faure).",
        values=SCRAMBLINGS,
        optional=True,
        details="It is the same in every replicate. None: none, or as an older name in numbers says.",
    ),
    Option(
        "randomisation",
        "by-patch: each patch shifts the sequence by its own amount. shared: one shift for all patches.",
        values=RANDOMISATIONS,
        details="Random numbers have no shift: each patch has its own in any case. Lines that begin at no patch (global lines, "
        "fractional absorption) share one in any case.",
    ),
    Option(
        "padding",
        "How walks that draw numbers at each hit get those of later segments: shuffled or prime-bases (halton).",
        values=PADDINGS,
        details="See docs/numbers.md.",
    ),
    Option(
        "estimator",
        "What is counted of a walk or line: collision, absorption, survival, gathering, bidirectional.",
        values=ESTIMATORS,
    ),
    Option(
        "absorption",
        "How a walk ends: rounded, drawn, fractional.",
        values=AUTO | ABSORPTIONS,
        details="auto: " + AUTO["auto"] + ".",
    ),
    Option(
        "first_shot",
        "Global lines: share of all lines that sends the power of the lights by local lines first, such as 25%.",
        kind="share",
        zero=True,
        details="0 is none.",
    ),
    Option(
        "control_variate",
        "Iterations: take a constant radiosity out of what lines carry.",
        kind="switch",
        details="It is put back exactly.",
    ),
    Option("warm_up", "Regular iterations: begin with incremental ones.", kind="switch", details="Their bias is small."),
    Option(
        "reconstruction",
        "Particles: patches (hits are counted) or local-linear (planes are fitted to them). Gather: patches or smooth.",
        details="smooth: values are smoothed over each plane, as far as noise asks for it; it needs 2 replicates or more.",
        values=RECONSTRUCTIONS,
    ),
    Option(
        "basis",
        "How light varies over a patch: constant, linear or quadratic. Of iterations, gathers and particles.",
        values=BASES,
        details="See docs/bases.md.",
    ),
    Option(
        "refine_lines",
        "Iterations: lines bring light to elements of many patches. An element may err by this share of what the scene emits, "
        "such as 1e-5.",
        kind="share",
        zero=True,
        share_of="what the scene emits",
        details="0: to patches. See docs/iterations.md.",
    ),
    Option(
        "coherent",
        "Trace similar lines together where a table of measured costs says that it pays: with AVX-512, where patches fire 2304 "
        "lines or more in a wavefront. Bits may differ where a line meets two faces in one point.",
        kind="flag",
        values={"always": "on any processor, wherever patches fire enough lines"},
        tuning=True,
        details="It sets Embree's coherent flag: at an exact tie of two faces the winner then depends on the packet of lines. "
        "Where it does not pay, or nobody has measured that it does, as with AVX2, a warning says so, and lines are traced as "
        "without it. In Python 'always' does it on any processor.",
    ),
)

ROWS = ("full-matrix", "progressive")  # schemes that take rows of form factors from a source
BASELINE = table(
    Option("scheme", "How the equation is solved.", values=SCHEMES),
    Option("factors", "Source of form factors: polygons, hemicube, lines.", values=FACTORS, schemes=ROWS),
    Option(
        "solver",
        "full-matrix: jacobi, gauss-seidel, southwell, conjugate-gradients.",
        values=SOLVERS,
        schemes=("full-matrix",),
    ),
    Option(
        "reciprocal",
        "full-matrix: make A_i F_ij symmetric, and rows sum to what does not escape.",
        kind="flag",
        schemes=("full-matrix",),
    ),
    Option(
        "resolution",
        "Hemicubes: pixels along an edge of the top.",
        kind="whole",
        most=2048,
        schemes=ROWS,
        details="An even number.",
    ),
    Option(
        "rotated",
        "Hemicubes: turned by random angles (the default), or aligned with their faces.",
        kind="switch",
        schemes=ROWS,
        details="Each patch has an angle of its own.",
    ),
    Option(
        "samples",
        "Lines for each pair of patches or link (16), or for each patch with --factors lines (4096).",
        kind="whole",
        most=65535,
        optional=True,
        schemes=(*ROWS, "hierarchical"),
        details="None: these numbers.",
    ),
    Option(
        "ambient",
        "Progressive refinement: add an estimate of the light that was not shot yet.",
        kind="flag",
        schemes=("progressive",),
        details="It is the same on all patches.",
    ),
    Option(
        "overshooting",
        "Progressive refinement: shoot a part of the light that is still to come, too.",
        kind="flag",
        schemes=("progressive",),
    ),
    Option(
        "epsilon",
        "Hierarchical radiosity: refine links whose error exceeds this share of what the scene emits, such as 1e-5.",
        kind="share",
        schemes=("hierarchical",),
        details="See docs/hierarchical.md.",
    ),
    Option(
        "refinement",
        "Hierarchical radiosity: brightness-factor, error-radiance, error-power.",
        values=REFINEMENTS,
        schemes=("hierarchical",),
    ),
)


def choices(options: dict[str, Option]) -> dict[str, tuple[str, ...]]:
    """Return the names of the values of each option that has named values."""
    return {name: tuple(option.values) for name, option in options.items() if option.kind == "choice"}
