"""The refinement of links: coarse links are replaced by links of children, until none is too coarse."""

import numpy as np

from ...errors import MethodError
from ...patches.clusters import Clusters
from .links import Links
from .making import Maker
from .oracle import Oracle, Radiosity

MOST_LINKS = 1 << 25  # links take 1 GiB, and three times as much while they are sorted


def refined(links: Links, oracle: Oracle, maker: Maker, radiosity: Radiosity, epsilon: float) -> tuple[Links, bool]:
    """Return the links that suffice for a radiosity, and whether any is new.

    Raises:
        MethodError: more links than can be kept.
    """
    coarse = oracle.too_coarse(links, radiosity, epsilon)
    kept, going = [links.take(~coarse)], links.take(coarse)
    if not len(going):
        return links, False
    while len(going):
        new = maker.make(*split(going, oracle, radiosity), radiosity.mean)
        coarse = oracle.too_coarse(new, radiosity, epsilon)
        kept.append(new.take(~coarse))
        going = new.take(coarse)
        count = sum(map(len, kept)) + len(going)
        if count > MOST_LINKS:
            raise MethodError(
                f"hierarchical radiosity has come to {count:.3g} links at epsilon {epsilon:.3g}, and {MOST_LINKS:.3g} are the "
                "most that are kept; take a larger epsilon, larger patches, or a method that forms no matrix"
            )
    return Links.joined(kept), True


def split(links: Links, oracle: Oracle, radiosity: Radiosity) -> tuple[np.ndarray, np.ndarray]:
    """Return the receivers and sources of the pairs that replace coarse links."""
    here = oracle.divides_receiver(links, radiosity)
    divided, other = np.where(here, links.receiver, links.source), np.where(here, links.source, links.receiver)
    clusters = oracle.levels.clusters
    if clusters is None:
        return _split_elements(oracle, here, divided, other)
    count = len(oracle.levels.hierarchy)
    flat = divided < count
    row, child = _children(clusters, divided[~flat] - count)
    same = np.flatnonzero((divided == other)[~flat][row])  # light within a cluster: between all pairs of its children
    apart = np.flatnonzero((divided != other)[~flat][row])
    again, pair = _children(clusters, divided[~flat][row[same]] - count)
    first = child[same][again]
    useful = (first != pair) | (first >= count)  # no element sees itself
    there, whole = here[~flat][row[apart]], other[~flat][row[apart]]
    parts = [
        _split_elements(oracle, here[flat], divided[flat], other[flat]),
        (np.where(there, child[apart], whole), np.where(there, whole, child[apart])),
        (first[useful], pair[useful]),
    ]
    receiver, source = (np.concatenate(column) for column in zip(*parts, strict=True))
    return receiver, source


def _children(clusters: Clusters, cluster: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the children of clusters by element numbers, one after the other, and which of the clusters each is of."""
    child, start = clusters.children
    counts = start[cluster + 1] - start[cluster]
    row = np.repeat(np.arange(len(cluster)), counts)
    within = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
    return row, child[start[cluster][row] + within]


def _split_elements(oracle: Oracle, here: np.ndarray, divided: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    children, other = oracle.levels.hierarchy.children(divided), other[:, None]
    receiver = np.where(here[:, None], children, other)
    source = np.where(here[:, None], other, children)
    exists = children >= 0
    return receiver[exists], source[exists]
