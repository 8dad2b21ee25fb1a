"""Algorithms whose replicates cannot be solved in several runs, and why."""

ALONE = {
    "pooling": "the warm-up of pooled global lines balances the power of all replicates together",
    "progressive": "progressive refinement has no replicates",
    "hierarchical": "hierarchical radiosity has no replicates",
}
