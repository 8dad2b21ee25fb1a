"""The choice of the padding: how a walk that takes numbers on each of its segments gets those of later segments."""

PADDINGS = {
    "shuffled": "the same sequence with its points in another order for each segment (Latin supercube sampling)",
    "prime-bases": "halton: the next prime bases for each segment, as Keller 1996; walk n is point n of one sequence",
}
