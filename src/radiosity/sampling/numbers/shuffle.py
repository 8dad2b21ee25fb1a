"""More dimensions than a sequence has: copies of it in other orders, one for each segment of a walk.

A. B. Owen, "Latin supercube sampling for very high-dimensional simulations", ACM TOMACS 8(1), 1998, pads a sequence with shuffled
copies of itself; B. Burley, "Practical hash-based Owen scrambling", JCGT 9(4), 2020, shuffles by a nested uniform permutation of
the index in base 2, computed by a hash. So every aligned block of 2^m lines takes the points of an aligned block, and a copy
is as even as the sequence.

In such a permutation the bits above a bit say whether it is flipped. Burley's hash leaves relations between the flips of
neighbours, since the carries of sums and products are as simple as the sums. The steps here multiply bits too (A. Klimov and
A. Shamir, "A new class of invertible mappings", CHES 2002). After four rounds no relation was measured with 10^6 keys.
"""

import drjit as dr

SHUFFLE_BITS = 28
MASK = 2**SHUFFLE_BITS - 1
FACTORS = (  # of each round; odd, so that each bit of a product holds the same bit of the number
    (0x6C50B47D, 0xB82F1E53),
    (0xC7AFE639, 0x8D22F6E7),
    (0x3D20ADEB, 0x05526C57),
    (0x53A22865, 0x9E3779B1),
)


def key(randomisation, segment):
    """Return the key of a segment, UInt32, another for each; zero for segment 0 (and, with a chance of 2^-32, for one more).

    Args:
        randomisation: eight UInt32, of the scene and replicate.
        segment: UInt32, its number: how often the walk was reflected before; it may differ from lane to lane.
    """
    mixed = segment
    for word in randomisation[4:]:
        mixed = mix(mixed + word)
    return dr.select(segment == 0, type(segment)(0), mixed)


def shuffled(index, key):
    """Return the index of the point that a line takes: UInt32 in [1, 2^28], another permutation for each key; key 0 changes none.

    Args:
        index: UInt32 in [1, 2^28]; larger ones begin again at 1.
        key: UInt32, see `key`.
    """
    place = (index - 1) & MASK
    x = dr.brev(place) >> (32 - SHUFFLE_BITS)  # a bit depends on those below it from here on
    first = key
    for a, b in FACTORS:
        second = first * 0x9E3779B1
        second = second ^ (second >> 15)
        x = x + first
        first = second * 0x85EBCA6B
        first = first ^ (first >> 13)
        x = x ^ (((x * a ^ second) & (x * b ^ first)) << 1)
    moved = dr.brev(x << (32 - SHUFFLE_BITS))
    return dr.select(key == 0, place, moved) + 1


def mix(x):
    """Map 32-bit words by a bijection in which each bit depends on all (C. Wellons, "Prospecting for hash functions", 2018)."""
    x = (x ^ (x >> 16)) * 0x7FEB352D
    x = (x ^ (x >> 15)) * 0x846CA68B
    return x ^ (x >> 16)
