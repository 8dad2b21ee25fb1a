"""The choice of the estimator: what is scored of a walk or a line."""

ESTIMATORS = {
    "collision": "every hit scores",
    "absorption": "the hit that ends a walk scores, over its probability",
    "survival": "the hits that a walk survives score",
    "gathering": "walks from the patches to the light: every patch on the way gathers the emission found behind it",
    "bidirectional": "both ends of a line score, each by its share of the density that the line was drawn with",
}
ABSORPTIONS = {
    "rounded": "a patch re-emits its reflectance times its arrivals, rounded: no number is drawn",
    "drawn": "a number of its own decides at each hit",
    "fractional": "a fixed share of all walks goes on at each bounce, with weights for the rest",
}
