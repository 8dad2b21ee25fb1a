"""Comparisons of two solutions of one scene: differences, and whether their errors explain them."""
