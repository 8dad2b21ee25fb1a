"""Values of links with clusters from lines of their own, once no link is divided any more.

A link that looks dark by chance is kept, and one that looks bright by chance is divided, so the lines that judge a link say too
little of those that are kept. Lines that had no say in that give F_rs in the mean: A_s / pi times the mean of cos cos' / r² over
pairs of points that see each other. Sides of a source are drawn in proportion to the power that leaves them, so the factor is
that of the cluster as it shines.
"""

import numpy as np

from ...patches.clusters import Clusters
from ...tracing.geometry import Geometry
from .ends import Ends
from .links import Links
from .parameters import Hierarchical
from .sampled import sampled

STREAM = 1  # lines of these numbers judge no link


def valued(
    clusters: Clusters, geometry: Geometry, parameters: Hierarchical, links: Links, power: np.ndarray
) -> tuple[Links, int]:
    """Return links with clusters as they are, but for their factors, and the number of rays.

    Args:
        power: (n_sides,) float64, W or lm, what leaves each side.
    """
    one, other = Ends.of(clusters, links.receiver), Ends.of(clusters, links.source)
    reach = np.concatenate([[0], np.cumsum(power[clusters.order])])
    (_, seen), _ = sampled(clusters, geometry, (parameters.rays, parameters.seed), one, other, STREAM, reach)
    factor = np.minimum(seen * other.area / np.pi, np.minimum(1, other.area / one.area))
    return Links(links.receiver, links.source, factor, links.spread), len(links) * parameters.rays
