"""The refinement of links: coarse links are replaced by links of children, until none is too coarse."""

import numpy as np

from ...errors import MethodError
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
        new = maker.make(*split(going, oracle, radiosity))
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
    children = oracle.levels.hierarchy.children(np.where(here, links.receiver, links.source))
    other = np.where(here, links.source, links.receiver)[:, None]
    receiver = np.where(here[:, None], children, other)
    source = np.where(here[:, None], other, children)
    exists = children >= 0
    return receiver[exists], source[exists]
