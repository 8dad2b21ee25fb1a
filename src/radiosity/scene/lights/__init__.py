"""Lights without area, as values: luminaires, the sun and the sky."""
