"""Lines that reach no surface: what escapes needs surroundings, and absorbing backs have no temperature."""

import warnings
from dataclasses import replace

import numpy as np

from ..errors import RadiosityWarning, SceneError, shown
from ..patches.model import Patches
from ..scene.model import Back
from .network import Network, Pooled

LEAK = 1e-3  # share of a side's lines that may escape through seams, where no surroundings are given
HIDDEN = 0.99  # share of lines that end on backs, from which a patch is hidden, such as floor below furniture
UNDEFINED = 0.2  # largest share of a side's lines that may end on backs, hidden patches apart


def refuse_one_way(patches: Patches) -> None:
    """Refuse backs that let lines pass: they would let heat through one way only.

    Raises:
        SceneError: there are some.
    """
    scene = patches.scene
    one_way = np.isin(scene.back, (Back.PASSES, Back.OPEN))
    if one_way.any():
        names = shown([scene.names[i] for i in np.unique(scene.surface[one_way])])
        raise SceneError(
            f"lines pass through the backs of {names}, so that heat would go one way only; give them sides = 1 (absorbing "
            "backs) or sides = 2 in a .toml"
        )


def closed(network: Network, surroundings: float | None) -> Network:
    """Return the network without what escapes, where there are no surroundings."""
    return network if surroundings is not None else replace(network, escaping=np.zeros_like(network.escaping))


def check(patches: Patches, pooled: Pooled, surroundings: float | None) -> None:
    """Tell of lines that end on absorbing backs, or escape where no surroundings are given.

    Such lines count as if they came back to the patch that they left: the patch then loses nothing by them.

    Raises:
        SceneError: they are too many for that.
    """
    escaped = pooled.network.escaping / pooled.area
    if surroundings is None and escaped.any():
        share, names = _of_sides(patches, escaped, np.ones(len(patches), bool))
        if max(share) > LEAK:
            raise SceneError(
                f"{max(share):.2%} of what leaves {names[0]} leaves the scene; give surroundings, in K (0 K: nothing comes "
                "back). Where that is the outside of a closed scene, give the surface sides = 1 in a .toml"
                + (f"; also of {shown(names[1:])}" if names[1:] else "")
            )
        text = "of their lines escape through seams; they count as if they came back"
        warnings.warn(f"{shown(names)}: up to {max(share):.1g} {text}", RadiosityWarning, stacklevel=4)
    hidden = pooled.lost > HIDDEN
    share, names = _of_sides(patches, pooled.lost, ~hidden)
    if names and max(share) > UNDEFINED:
        raise SceneError(
            f"{max(share):.1%} of what leaves {names[0]} ends on absorbing backs, which have no temperature; give the surfaces "
            "whose backs it sees sides = 2 in a .toml (two_sided=True)" + (f"; also {shown(names[1:])}" if names[1:] else "")
        )
    if names:
        text = "of their lines end on absorbing backs; they count as if they came back"
        warnings.warn(f"{shown(names)}: up to {max(share):.2g} {text}", RadiosityWarning, stacklevel=4)
    if hidden.any():
        names = [patches.scene.names[i] for i in np.unique(patches.surface[hidden])]
        text = f"{hidden.sum()} patches of {shown(names)} see nothing but absorbing backs, and exchange no heat"
        warnings.warn(text, RadiosityWarning, stacklevel=4)


def _of_sides(patches: Patches, share: np.ndarray, counted: np.ndarray) -> tuple[list[float], list[str]]:
    """Shares of the lines of sides of surfaces, largest first, and the names of these sides; those above zero alone."""
    k = len(patches.scene.names)
    side = patches.surface + k * patches.is_back
    area = np.bincount(side[counted], patches.area[counted], 2 * k)
    part = np.bincount(side[counted], (patches.area * share)[counted], 2 * k) / np.maximum(area, np.finfo(float).tiny)
    order = [i for i in np.argsort(-part, kind="stable") if part[i] > 0]
    names = patches.scene.names
    return [float(part[i]) for i in order], [f"the back of {names[i - k]}" if i >= k else names[i] for i in order]
