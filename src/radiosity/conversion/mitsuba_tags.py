"""Elements of Mitsuba's XML that several parts of a file share."""

import numpy as np


def rgb(name: str, values: np.ndarray) -> str:
    """Return a colour; one number stands for three."""
    return f'<rgb name="{name}" value="{numbers(np.broadcast_to(values, (3,)))}"/>'


def numbers(values) -> str:
    """Return numbers with all their digits, between blanks."""
    return " ".join(f"{float(value)!r}" for value in values)


def transform(origin, forward, up) -> str:
    """Return the transformation that brings the z axis to where something looks."""
    forward = np.asarray(forward, np.float64)
    places = f'origin="{numbers(origin)}" target="{numbers(np.add(origin, forward))}" up="{numbers(up)}"'
    return f'<transform name="to_world"><lookat {places}/></transform>'
