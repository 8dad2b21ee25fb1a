"""The axis of the equation: the point from which a particle leaves a patch that it hit."""

EQUATIONS = {
    "discrete": "from a fresh uniform point of the patch: the walk solves the equation of the patches",
    "continuous": "from the point that it hit: the walk solves the continuous equation, and patches only count",
}
