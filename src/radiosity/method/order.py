"""The axis of the order: which line is fired next."""

ORDERS = {
    "depth-first": "each walk is followed to its end",
    "breadth-first": "wavefront after wavefront: all light reflected k times before any reflected k + 1 times",
    "staged": "breadth-first in stages of ever more, weaker lines; a picture after each",
    "sorted": "breadth-first; before each wavefront particles are sorted by place, and take their numbers in that order",
    "well-distributed": "in stages of half the quantum each; a patch fires what it lacks to its share",
    "incremental": "iterations that send the light not sent yet, in ever fewer lines",
    "regular": "iterations that send all light anew, averaged",
    "gather": "every patch fires shadow rays to the lamps, and cosine lines that read a solution along stored lines",
    "multipath": "each line carries on what earlier lines left on the patches it crosses",
    "matrix": "lines give form factors first; the equation is solved afterwards",
}
