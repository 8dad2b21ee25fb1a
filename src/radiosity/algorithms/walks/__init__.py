"""Walks that draw their absorption: particles that shoot from lights or gather from patches, launch by launch."""
