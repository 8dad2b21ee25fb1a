"""Limits of what sensors may be."""

LARGEST = 1e6  # m: farther points are errors of units
