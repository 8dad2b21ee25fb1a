"""The choice of the reconstruction: what becomes of the values of patches."""

RECONSTRUCTIONS = {
    "patches": "each patch has the value that its own lines tell",
    "smooth": "values are smoothed over each plane where replicates show noise, and not at edges of shadows",
    "local-linear": "planes are fitted to the hits about each point",
}
