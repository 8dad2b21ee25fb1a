"""Diagnostics: what a scene holds, and what in it is probably not meant."""
