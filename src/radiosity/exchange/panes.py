"""Emissivities of panes: those of their solid part, which is what exchanges heat (`Patches.solid`)."""

import numpy as np

from ..errors import SceneError, shown
from ..patches.model import Patches

ROUNDING = 1e-12  # by which a sum may be above 1


def of_solid(patches: Patches, emissivity: np.ndarray) -> np.ndarray:
    """Return emissivities of the solid part, of the same shape: those of the whole pane over 1 - transmittance.

    Args:
        emissivity: (n_patches,) or (n_bands, n_patches), of whole panes.

    Raises:
        SceneError: emissivity and transmittance are above 1 together, or panes diffuse light: exchange does not cross them.
    """
    scene = patches.scene
    if scene.diffusers.any():
        names = shown([scene.names[i] for i in np.unique(scene.surface[scene.diffusers])])
        raise SceneError(
            f"{scene.source}: {names} let light through diffusely (diffuse_transmittance), and an exchange of heat does not "
            "cross them: leave it out for heat, or give a clear transmittance"
        )
    if patches.scene.transmittance is None:
        return emissivity
    through = patches.transmittance
    wrong = np.atleast_2d(emissivity + through > 1 + ROUNDING) & (through > 0)
    if wrong.any():
        band, patch = np.argwhere(wrong)[0]
        name, value = patches.scene.names[patches.surface[patch]], np.atleast_2d(emissivity)[band, patch]
        raise SceneError(
            f"{patches.scene.source}: surface '{name}' has emissivity {value:g} and transmittance {through[patch]:g}, above 1 "
            "together; lower one of them: the rest, up to 1, is reflected"
        )
    return np.minimum(emissivity / (1 - through), 1.0)
