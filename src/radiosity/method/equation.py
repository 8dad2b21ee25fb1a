"""Where does a particle leave a patch it hit?"""

EQUATIONS = {
    "discrete": "from a fresh uniform point of the patch: the walk solves the equation of the patches",
    "continuous": "from the point that it hit: the walk solves the continuous equation, and patches only count",
}
