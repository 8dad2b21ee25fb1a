"""How view factors were restored, and up to how many groups by least squares."""

RAW, LEAST_SQUARES, SCALING = "", "least squares", "scaling"
SAMPLED = 2000  # groups: with more, the values of single replicates are not kept, and factors are restored by scaling
