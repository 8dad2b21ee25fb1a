"""The choice of the scrambling: what is changed in a sequence before it is randomised, alike in all replicates and patches."""

SCRAMBLINGS = {
    "none": "points as the sequence is defined",
    "permuted-digits": "halton: the digits of the index go through Faure's permutations of 1992, one for each base",
    "linear": "faure: its matrices are multiplied by lower triangular ones (Tezuka 1993): generalised Faure points",
}
