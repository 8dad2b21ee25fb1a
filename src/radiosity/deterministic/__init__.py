"""The baselines: radiosity methods that do form the matrix, or that compute its entries one by one."""
