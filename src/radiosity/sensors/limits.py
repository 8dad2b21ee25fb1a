"""Limits of what sensors may be."""

LARGEST = 1e9  # m: maps have coordinates of some 1e6 m; farther points are errors of units
