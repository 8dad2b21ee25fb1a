"""What a baseline is made of: how the equation is solved, where form factors come from, which solver, which links are cut."""

SCHEMES = {
    "full-matrix": "all form factors first, then the equation is solved",
    "progressive": "the patch with the most unshot power shoots next, along a row of form factors made for it",
    "hierarchical": "links between elements of all sizes, refined where they would err",
}
FACTORS = {
    "polygons": "exact form factors of polygons, times the share of lines between two patches that nothing stops",
    "hemicube": "item buffers of the five faces of a hemicube on the middle of each patch",
    "lines": "local lines from each patch, counted where they hit",
}
SOLVERS = {  # each is a file of factors/solvers
    "jacobi": "all patches at once from the last iterate",
    "gauss-seidel": "patch after patch, from the newest values",
    "southwell": "always the patch with the most unshot power, which is shot to all others",
    "conjugate-gradients": "conjugate gradients on the symmetric form of the equation; reciprocal form factors only",
}
REFINEMENTS = {
    "brightness-factor": "a link is cut where radiosity times form factor times area is large (Hanrahan et al. 1991)",
    "error-radiance": "a link is cut where its estimated error of radiosity is large (Bekaert and Willems 1996)",
    "error-power": "a link is cut where its estimated error of power is large (Bekaert and Willems 1996)",
}
