"""The choice of the reconstruction: hits become counts, or a fit."""

RECONSTRUCTIONS = {
    "patches": "hits are counted on each patch",
    "local-linear": "planes are fitted to the hits about each point",
}
