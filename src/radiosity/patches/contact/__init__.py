"""Cutting faces along contact lines, where other faces touch or pierce them. Light is not continuous there."""

from .cutting import cut_at_contacts

__all__ = ["cut_at_contacts"]
