"""Iterations of local lines: power sent by patches, incrementally or all of it anew."""
