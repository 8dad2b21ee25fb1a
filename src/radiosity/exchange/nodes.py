"""Nodes: patches of one temperature. They are kept at it, or float with the heat that they get from elsewhere.

A floating node is a cell of a face, with both its sides where both radiate: a sheet is as hot in front as behind. A surface that
conducts well (``isothermal``) is one node.
"""

from dataclasses import dataclass

import numpy as np

from ..patches.model import Patches
from ..scene.model import Back
from .network import Network


@dataclass(frozen=True, eq=False)
class Nodes:
    """The conditions of all patches.

    Attributes:
        temperature: (n_patches,) K, NaN on floating nodes.
        node: (n_patches,) int, the number of the floating node of each patch, -1 where the temperature is given.
        heat: (n_nodes,) W that a node gets from elsewhere, and gives off to the other surfaces.
        left_out: (n_patches,) bool, on floating nodes that exchange nothing with anything; their temperature is unknown.
    """

    temperature: np.ndarray
    node: np.ndarray
    heat: np.ndarray
    left_out: np.ndarray

    @staticmethod
    def of(patches: Patches, temperature: np.ndarray, heat: np.ndarray, isothermal: np.ndarray, hidden: np.ndarray) -> "Nodes":
        """Make the nodes.

        Args:
            temperature: (n_surfaces,) K, NaN where floating.
            heat: (n_surfaces,) W of each floating surface. It is spread evenly over the area of its cells that are not hidden.
            isothermal: (n_surfaces,) bool, floating surfaces that are one node.
            hidden: (n_patches,) bool, patches that exchange nothing.
        """
        surface, floats = patches.surface, np.isnan(temperature)[patches.surface]
        cell = _cells(patches)
        key = np.where(isothermal[surface], cell.max(initial=0) + 1 + surface, cell)
        _, node = np.unique(key[floats], return_inverse=True)
        number = np.full(len(patches), -1)
        number[floats] = node
        n = int(node.max(initial=-1)) + 1
        seen = np.bincount(node, ~hidden[floats], n) > 0
        # the area of a node is that of its cells, not of their sides
        _, first = np.unique(cell[floats], return_index=True)
        here = np.flatnonzero(floats)[first]
        area = np.bincount(number[here], patches.area[here], n) * seen
        of_surface = np.zeros(n, np.int64)
        of_surface[node] = surface[floats]
        whole = np.bincount(of_surface, area, len(temperature))[of_surface]
        watts = heat[of_surface] * np.divide(area, whole, out=np.zeros(n), where=whole > 0)
        left_out = np.zeros(len(patches), bool)
        left_out[floats] = ~seen[node]
        return Nodes(temperature[surface], number, watts, left_out)

    @property
    def fixed(self) -> np.ndarray:
        """Patches of given temperature, (n_patches,) bool."""
        return self.node < 0

    def adrift(self, network: Network, *, surroundings: bool) -> np.ndarray:
        """Return the patches that no path of exchange joins to a given temperature, (n_patches,) bool.

        Args:
            surroundings: what escapes goes to surroundings of given temperature.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        n, floating = len(self.node), np.flatnonzero(~self.fixed)
        held = self.fixed | (network.escaping > 0 if surroundings else False)
        pairs, joined = network.exchange.tocoo(), network.exchange.data > 0
        # patches, then nodes, then one end for all that is held
        rows = np.concatenate([pairs.row[joined], floating, np.flatnonzero(held)])
        columns = np.concatenate([pairs.col[joined], n + self.node[floating], np.full(held.sum(), n + len(self.heat))])
        size = n + len(self.heat) + 1
        _, label = connected_components(coo_array((np.ones(len(rows)), (rows, columns)), shape=(size, size)), directed=False)
        return label[:n] != label[-1]


def _cells(patches: Patches) -> np.ndarray:
    """The number of the cell of each patch, (n_patches,); the front and the radiating back of a cell have the same."""
    face = patches.face
    back = np.where(patches.is_back, patches.cells_per_face[face], 0)
    first = np.cumsum(patches.cells_per_face) - patches.cells_per_face
    both = (patches.scene.back == Back.RADIATES).any()
    inside = np.arange(len(patches)) - patches.first[face] - (back if both else 0)
    return first[face] + inside
