"""The study of Bekaert, Cools and Willems, "An empirical comparison of Monte Carlo radiosity algorithms", on this program."""
