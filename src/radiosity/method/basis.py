"""The choice of the basis: how light varies over a patch."""

BASES = {
    "constant": "each patch has one value",
    "linear": "light on a patch is a polynomial of degree 1 of the place: 3 numbers",
    "quadratic": "a polynomial of degree 2: 6 numbers",
}
