"""Importance: what light that leaves a patch is worth for a surface, a camera or sensors, by which lines are shared out."""
