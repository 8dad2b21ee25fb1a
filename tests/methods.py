"""The table of methods that the table tests run, and how their replicates are compared with references.

A new preset is in the table by itself; a combination of choices that no preset makes is one line here.
"""

from scipy import stats

import radiosity as rd

COMBINATIONS = {
    "continuous, sobol": rd.Method(equation="continuous", numbers="sobol"),
    "continuous, depth-first, random": rd.Method(equation="continuous", order="depth-first", numbers="random"),
    "continuous, staged": rd.Method(equation="continuous", order="staged"),
    "discrete, drawn": rd.Method(absorption="drawn"),
    "discrete, absorption": rd.Method(estimator="absorption"),
    "discrete, survival": rd.Method(estimator="survival"),
    "discrete, gathering": rd.Method(estimator="gathering"),
    "discrete, fractional": rd.Method(absorption="fractional"),
    "continuous, absorption": rd.Method(equation="continuous", estimator="absorption"),
    "continuous, survival": rd.Method(equation="continuous", estimator="survival"),
    "continuous, gathering": rd.Method(equation="continuous", estimator="gathering"),
    "depth-first": rd.Method(order="depth-first"),
    "incremental, bidirectional": rd.Method(order="incremental", estimator="bidirectional"),
    "multipath, disc": rd.Method(lines="global-disc", order="multipath"),
    "multipath, spans, first shot": rd.Method(lines="spans", order="multipath", first_shot=0.3),
    "pooled, global": rd.Method(lines="global", order="regular"),
    "pooled, spans, first shot": rd.Method(lines="spans", order="regular", first_shot=0.3),
    "matrix, local": rd.Method(order="matrix"),
    "matrix, spans": rd.Method(lines="spans", order="matrix"),
    "matrix, bundles": rd.Method(lines="bundles", order="matrix"),
}
METHODS = {name: preset.method for name, preset in rd.PRESETS.items()} | COMBINATIONS

ALPHA = 1e-4  # of all comparisons of one test together (Bonferroni)


def critical(replicates: int, comparisons: int) -> float:
    """Student's bound for the largest of so many differences at `ALPHA`."""
    return float(stats.t.ppf(1 - ALPHA / comparisons / 2, replicates - 1))
