"""The state of a gather between two launches."""

from dataclasses import dataclass, fields

import numpy as np

from ..merge_rules import alike
from ..state import AbstractState, Sizes, array, number


@dataclass(frozen=True, eq=False, kw_only=True)
class GatherState(AbstractState):
    """Sums of what lines brought, in fixed point.

    Where the lines of each patch hit is not kept: it follows from the seed, and is traced again. With a basis of K functions,
    groups in the layouts of arrays are columns: K for each group of bands (`moments`).

    Attributes:
        done: N up to which lines have been traced.
        cosine, rays: (n_patches,), cosine lines and shadow rays of each patch in a replicate; uint32 where that suffices, else
            uint64.
        stored: (n_patches,), of the same type, how many of the cosine lines are stored.
        brought: (replicates, n_patches, groups) uint64, sums of shadow rays.
        met: (replicates, n_patches, groups) int64, sums of cosine lines.
        brought_upper, met_upper: int64, what is above the words of these, where they have been too long; ``met`` is then uint64.
        reflected: (replicates, n_patches, groups) float32, the radiosity that lines read, in shares of the largest emission.
        halves: (2, replicates, n_patches, groups) float32, by how much that differs along each half of the stored lines.
        first_bias, bias_left: (replicates, n_patches, groups) float32, the bias of irradiance after the first correction and
            after the last one, in shares of the largest emission.
        missed: (2, replicates, n_patches) uint32 or uint64, cosine lines that escaped and were lost.
        unsolved: (replicates,) float64, what iterations have left of the solution along stored lines, at most, as `bias_left`.
    """

    done: int = number(int)
    cosine: np.ndarray = array("rows", merged=alike)
    rays: np.ndarray = array("rows", merged=alike)
    stored: np.ndarray = array("rows", merged=alike)
    brought: np.ndarray = array("replicates", "rows", "groups")
    met: np.ndarray = array("replicates", "rows", "groups")
    brought_upper: np.ndarray | None = array("replicates", "rows", "groups", optional=True, zeros=True)
    met_upper: np.ndarray | None = array("replicates", "rows", "groups", optional=True, zeros=True)
    reflected: np.ndarray = array("replicates", "rows", "groups")
    halves: np.ndarray = array(2, "replicates", "rows", "groups")
    first_bias: np.ndarray = array("replicates", "rows", "groups")
    bias_left: np.ndarray = array("replicates", "rows", "groups")
    missed: np.ndarray = array(2, "replicates", "rows")
    unsolved: np.ndarray = array("replicates")

    @property
    def unfinished(self) -> bool:
        return self.done < self.quanta

    @classmethod
    def empty(cls, sizes: Sizes, quanta: int) -> "GatherState":
        """Return the state before the first line."""
        values = {"sizes": sizes, "quanta": quanta, "done": 0}
        counts = dict.fromkeys(("cosine", "rays", "stored", "missed"), np.uint32)
        kinds = counts | {"brought": np.uint64, "met": np.int64}
        for one in fields(cls):
            if "layout" in one.metadata and not one.metadata["zeros"]:
                values[one.name] = np.zeros(sizes.shape(one.metadata["layout"].axes), kinds.get(one.name, np.float32))
        return cls(**values)
