"""The choice of the randomisation: whether patches share the randomised points of a sequence."""

RANDOMISATIONS = {
    "by-patch": "each patch moves the sequence by a shift of its own: means over surfaces of many patches are accurate",
    "shared": "all patches of a replicate share one shift, as in the paper: the k-th lines of all patches are parallel",
}
