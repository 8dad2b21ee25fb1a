"""Photometric types A and B of LM-63 as type C: intensities are looked up in the table, linear in both angles.

Type B, of floodlights: planes V turn about the horizontal axis of C = 90 and C = 270, and H lies in them. H = V = 0 is gamma = 0,
and V = 90 is C = 0. Type A, of headlamps: planes H turn about the vertical axis, and V lies in them. H = V = 0 becomes gamma = 0,
so that a luminaire is aimed by the middle of its beam; V = 90, above it, becomes C = 0. In both, H is positive to the side of
C = 270.
"""

import numpy as np

from .photometry import differs
from .web import Web

FINEST, COARSEST = 0.25, 2.5  # degrees between the entries of the new table
PLANES = 144


def to_type_c(kind: str, around: np.ndarray, across: np.ndarray, table: np.ndarray, notes: list[str]) -> Web:
    """Return the web of a table of type A or B, (n_horizontal, n_vertical)."""
    if len(around) > 1 and around[0] == 0:  # the same on both sides
        around, table = np.append(-around[:0:-1], around), np.concatenate([table[:0:-1], table])
    step = float(np.clip(min(np.diff(across).min(), np.diff(around).min(initial=90.0)) / 2, FINEST, COARSEST))
    gamma = np.linspace(0, 180, int(np.ceil(180 / step)) + 1)
    planes = np.linspace(0, 360, PLANES + 1)
    c, g = np.radians(planes)[:, None], np.radians(gamma)[None, :]
    x, y, z = np.cos(c) * np.sin(g), np.sin(c) * np.sin(g), np.cos(g) + 0 * c  # to C = 0, C = 90, gamma = 0
    if kind == "B":
        h, v = np.arcsin(np.clip(-y, -1, 1)), np.arctan2(x, z)
    else:
        h, v = np.arctan2(-y, z), np.arcsin(np.clip(x, -1, 1))
    web = Web(planes, gamma, _looked_up(around, across, table, np.degrees(h), np.degrees(v)))
    own = _flux(kind, around, across, table)
    if differs(own, web.flux):
        notes.append(f"its table of type {kind} makes {own:.5g} lm, and {web.flux:.5g} lm as a table of type C, which is taken")
    return web


def _looked_up(around, across, table: np.ndarray, h: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return intensities at angles H and V, degrees; zero outside of the table."""
    if len(around) == 1:
        return np.interp(v, across, table[0], left=0, right=0)
    i = np.clip(np.searchsorted(around, h, side="right") - 1, 0, len(around) - 2)
    j = np.clip(np.searchsorted(across, v, side="right") - 1, 0, len(across) - 2)
    a = (h - around[i]) / (around[i + 1] - around[i])
    b = (v - across[j]) / (across[j + 1] - across[j])
    value = (1 - a) * ((1 - b) * table[i, j] + b * table[i, j + 1]) + a * ((1 - b) * table[i + 1, j] + b * table[i + 1, j + 1])
    rim = 1e-9
    return np.where((a >= -rim) & (a <= 1 + rim) & (b >= -rim) & (b <= 1 + rim), np.maximum(value, 0), 0)


def _flux(kind: str, around, across, table: np.ndarray) -> float:
    """Return the integral of a table over its own angles, by the middles of fine cells."""
    if len(around) == 1:
        around, table = np.array([-90.0, 90.0]), table.repeat(2, axis=0)
    h, v = (_middles(angles) for angles in (around, across))
    values = _looked_up(around, across, table, h[:, None], v[None, :])
    inner = h[:, None] if kind == "B" else v[None, :]  # the angle within the planes
    area = np.radians(h[1] - h[0]) * np.radians(v[1] - v[0]) * np.cos(np.radians(inner))
    return float((values * area).sum())


def _middles(angles: np.ndarray) -> np.ndarray:
    count = 720
    return angles[0] + (np.arange(count) + 0.5) * (angles[-1] - angles[0]) / count
