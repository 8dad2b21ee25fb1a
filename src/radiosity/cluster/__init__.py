"""Runs on many machines: the workers of a Dask scheduler trace lines, and this process drives them (contract 16)."""
