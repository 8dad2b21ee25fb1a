"""The baselines: radiosity methods that do form the matrix, or a hierarchy of it."""
