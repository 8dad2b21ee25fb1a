"""Combinations of choices: which algorithm runs them, and why others are refused."""

from ..errors import MethodError

# The orders that each kind of run takes; an order that no list names is refused
FIRING_ORDERS = ("depth-first", "breadth-first", "staged", "well-distributed")
WALK_ORDERS = ("depth-first", "breadth-first", "staged", "sorted")
ITERATIONS = ("incremental", "regular")
GLOBAL_ORDERS = ("multipath", "matrix", "regular")


def machine(method) -> str:
    """The algorithm that runs a method.

    Raises:
        MethodError: the combination makes no sense, with the reason.
    """
    found = _local(method) if method.lines == "local" else _global(method)
    _refuse_options(method, found)
    return found


def _local(method) -> str:
    if method.order == "multipath":
        raise MethodError("order 'multipath' carries power along lines that cross many patches; take --lines global")
    if method.order in (*ITERATIONS, "matrix", "gather"):
        if method.equation != "discrete":
            raise MethodError(
                f"order '{method.order}' sends the power of whole patches, wherever on them it arrived: "
                "it solves the discrete equation only"
            )
        return method.order if method.order in ("matrix", "gather") else "iteration"
    if method.order == "sorted":
        _refuse_sorted(method)
    fires = method.equation == "discrete" and method.estimator == "collision" and method.absorption in ("auto", "rounded")
    if fires and method.order in FIRING_ORDERS:
        return "firing"
    if method.order not in WALK_ORDERS:
        raise MethodError(
            f"order '{method.order}' belongs to patches that fire whole lines to a target count: equation discrete, estimator "
            f"collision, absorption rounded; walks of other kinds take {', '.join(WALK_ORDERS)}"
        )
    if method.estimator == "bidirectional":
        raise MethodError(
            "estimator 'bidirectional' weighs the two ends of single lines: it needs an iteration "
            f"({', '.join(ITERATIONS)}), not walks"
        )
    if method.absorption == "rounded":
        raise MethodError(
            f"absorption 'rounded' is for counted hits (equation discrete, estimator collision), not for "
            f"equation {method.equation} with estimator {method.estimator}; take drawn or fractional"
        )
    if method.absorption == "fractional" and method.estimator != "collision":
        raise MethodError(
            f"absorption 'fractional' has no probability of its own at a hit, which estimator "
            f"'{method.estimator}' divides by; take collision"
        )
    if method.order == "depth-first" and method.absorption == "fractional":
        raise MethodError("absorption 'fractional' lets a share of all walks go on together; take --order breadth-first")
    if method.estimator == "gathering":
        if method.order == "depth-first":
            raise MethodError("estimator 'gathering' goes back along walks whose hits wavefronts have kept; take breadth-first")
        return "gathering"
    return "walks"


def _refuse_sorted(method) -> None:
    if method.equation != "continuous":
        raise MethodError(
            "order 'sorted' sorts particles by where on a face they are, which the discrete equation forgets; take --equation "
            "continuous, or another order"
        )
    if method.absorption == "fractional":
        raise MethodError("order 'sorted' decides itself which particles go on; leave absorption out")
    if method.estimator == "gathering":
        raise MethodError("order 'sorted' is for particles that shoot; take another estimator, or --order breadth-first")


def _global(method) -> str:
    if method.equation != "discrete":
        raise MethodError(
            "a global line leaves each patch where it happens to cross it, which is a fresh uniform point: "
            "global lines solve the discrete equation only"
        )
    if method.order not in GLOBAL_ORDERS:
        raise MethodError(
            f"order '{method.order}' chooses the patch that fires next, but global lines cross patches as they "
            "come; take multipath, matrix or regular"
        )
    if method.order == "multipath":
        if method.lines == "bundles":
            raise MethodError(
                "the lines of a bundle are parallel: what one leaves on a patch cannot turn within the bundle; "
                "take --order regular or matrix with bundles"
            )
        return "multipath"
    return "matrix" if method.order == "matrix" else "pooling"


def _refuse_padding(method, found: str) -> None:
    if found not in ("walks", "gathering") or method.order == "sorted":
        raise MethodError(
            f"padding '{method.padding}' is for walks that take numbers on each segment: take --absorption drawn or fractional, "
            f"or --equation continuous; the lines of {method.equation}/{method.lines}/{method.order} take five numbers or fewer"
        )
    if method.points != "halton":
        raise MethodError(
            f"padding '{method.padding}' goes on with the next dimensions of the Halton sequence: take --numbers halton without "
            f"scrambling, not {method.points}"
        )


def _refuse_options(method, found: str) -> None:
    if method.estimator != "collision" and found not in ("walks", "gathering", "iteration"):
        raise MethodError(
            f"estimator '{method.estimator}' is for walks and iterations of local lines, not for "
            f"{method.lines}/{method.order}; leave it out"
        )
    if found == "iteration" and method.estimator not in ("collision", "bidirectional"):
        raise MethodError(f"estimator '{method.estimator}' is for walks; iterations take collision or bidirectional")
    if method.absorption != "auto" and found not in ("firing", "walks", "gathering"):
        raise MethodError(
            f"absorption '{method.absorption}': nothing is absorbed on the way in {method.lines}/{method.order}, "
            "power is weighed instead; leave it out"
        )
    if method.padding != "shuffled":
        _refuse_padding(method, found)
    if method.first_shot and found not in ("multipath", "pooling"):
        raise MethodError("a first shot is for global lines of order multipath or regular: other methods begin at the lights")
    if method.control_variate and found != "iteration":
        raise MethodError("a constant control variate is taken out of what iterations send; take --order incremental or regular")
    if method.warm_up and method.order != "regular":
        raise MethodError("only regular iterations can begin with incremental ones (warm_up)")
    if method.warm_up and found != "iteration":
        raise MethodError("iterations by global lines have a warm-up of their own; leave warm_up out, or take --lines local")
    if method.refine_lines and found != "iteration":
        raise MethodError("refine_lines is for what iterations of local lines send; take --order incremental or regular")
    if method.refine_lines and method.basis != "constant":
        raise MethodError(
            f"refine_lines brings light to elements whose patches share it evenly, and basis '{method.basis}' lets it vary on "
            "each patch; leave one out"
        )
    if method.reconstruction == "local-linear" and (
        found != "walks" or method.equation != "continuous" or method.estimator == "gathering"
    ):
        raise MethodError("density estimation needs the points that particles hit: equation continuous, local lines, shooting")
    if method.reconstruction == "smooth" and found != "gather":
        raise MethodError(
            "reconstruction 'smooth' is for values that are means over the lines of each patch: take --order gather; hits are "
            "smoothed by reconstruction 'local-linear', which needs equation continuous"
        )
    walks = found == "walks" and method.equation == "continuous" and method.reconstruction == "patches"
    gathers = found == "gather" and method.reconstruction == "patches"
    if method.basis != "constant" and found != "iteration" and not walks and not gathers:
        raise MethodError(
            f"basis '{method.basis}' is for iterations of local lines (--method stochastic-jacobi), for gathers (--method gather)"
            " and for particles that go on from where they hit (--method particle-tracing), without smoothing: take one of "
            "these, or leave basis out"
        )
    fires = found == "firing" and method.order == "breadth-first" and method.points == "halton"
    if method.coherent and found != "gather" and not fires:
        raise MethodError(
            "coherent firing needs strata of the Halton sequence and whole wavefronts: discrete/local/breadth-first/"
            f"halton, not {method.lines}/{method.order}/{method.points}; leave one out, or take --order gather"
        )
