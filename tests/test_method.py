"""What a method is: choices, refusals with reasons, presets with citations."""

import contextlib
import itertools

import pytest

import radiosity as rd
from radiosity.algorithms.table import ALGORITHMS
from radiosity.method.model import AXES
from radiosity.method.presets.citations import CITATIONS


def test_a_method_prints_as_its_choices():
    assert str(rd.Method()) == "discrete/local/breadth-first/halton"
    assert str(rd.Method(equation="continuous", estimator="survival", numbers="sobol")) == (
        "continuous/local/breadth-first/sobol/survival"
    )
    assert str(rd.Method(randomisation="shared")) == "discrete/local/breadth-first/halton/shared"
    shot = rd.Method(lines="global", order="multipath", first_shot=0.25)
    assert str(shot) == "discrete/global/multipath/halton/first-shot=0.25"


@pytest.mark.parametrize(
    ("choices", "reason"),
    [
        ({"lines": "global", "equation": "continuous", "order": "multipath"}, "fresh uniform point"),
        ({"lines": "global"}, "cross patches as they come"),
        ({"lines": "spans", "order": "well-distributed"}, "cross patches as they come"),
        ({"lines": "bundles", "order": "incremental"}, "take multipath, matrix or regular"),
        ({"lines": "bundles", "order": "multipath"}, "parallel"),
        ({"order": "multipath"}, "take --lines global"),
        ({"order": "regular", "equation": "continuous"}, "discrete equation only"),
        ({"order": "matrix", "equation": "continuous"}, "discrete equation only"),
        ({"order": "well-distributed", "equation": "continuous"}, "depth-first, breadth-first, staged, sorted"),
        ({"order": "sorted"}, "take --equation continuous"),
        ({"order": "sorted", "equation": "continuous", "absorption": "fractional"}, "leave absorption out"),
        ({"order": "sorted", "equation": "continuous", "estimator": "gathering"}, "particles that shoot"),
        ({"estimator": "bidirectional"}, "two ends of single lines"),
        ({"estimator": "survival", "absorption": "rounded"}, "take drawn or fractional"),
        ({"estimator": "survival", "absorption": "fractional"}, "take collision"),
        ({"estimator": "survival", "order": "regular"}, "iterations take collision or bidirectional"),
        ({"estimator": "gathering", "order": "depth-first"}, "take breadth-first"),
        ({"absorption": "fractional", "order": "depth-first"}, "take --order breadth-first"),
        ({"absorption": "drawn", "order": "regular"}, "power is weighed instead"),
        ({"first_shot": 0.2}, "other methods begin at the lights"),
        ({"first_shot": 1.0, "lines": "global", "order": "multipath"}, "below 1"),
        ({"first_shot": "some", "lines": "global", "order": "multipath"}, "'some'"),
        ({"first_shot": float("nan"), "lines": "global", "order": "multipath"}, "below 1"),
        ({"control_variate": True}, "take --order incremental or regular"),
        ({"warm_up": True}, "only regular iterations"),
        ({"lines": "global", "order": "regular", "warm_up": True}, "warm-up of their own"),
        ({"reconstruction": "local-linear"}, "equation continuous"),
        ({"reconstruction": "smooth"}, "take --order gather"),
        ({"reconstruction": "smooth", "order": "regular"}, "means over the lines of each patch"),
        ({"reconstruction": "local-linear", "order": "gather"}, "equation continuous"),
        ({"reconstruction": "magic"}, "known are patches, smooth, local-linear"),
        ({"coherent": True, "order": "staged"}, "leave one out"),
        ({"estimator": "wishful"}, "known are collision"),
        ({"randomisation": "none"}, "known are by-patch, shared"),
        ({"absorption": "black"}, "known are auto, rounded"),
        ({"equation": "cubic"}, "known are discrete, continuous"),
    ],
)
def test_senseless_combinations_are_refused_with_the_reason(choices, reason):
    with pytest.raises(rd.MethodError, match=reason):
        rd.Method(**choices)


def test_every_combination_of_the_axes_is_run_by_a_process_or_refused():
    """No combination falls through, and no value is refused in all; a sequence of numbers goes with everything."""
    accepted = []
    for values in itertools.product(*AXES.values()):
        with contextlib.suppress(rd.MethodError):
            assert rd.Method(**dict(zip(AXES, values, strict=True))).machine in ALGORITHMS
            accepted.append(values)
    assert [set(taken) for taken in zip(*accepted, strict=True)] == [set(values) for values in AXES.values()]
    assert len(accepted) == len({values[:-1] for values in accepted}) * len(AXES["numbers"])


ALL = rd.PRESETS | rd.BASELINES


@pytest.mark.parametrize("name", ALL)
class TestPresets:
    def test_has_a_citation_in_bibtex(self, name):
        source = ALL[name].source
        entry = source.bibtex
        assert entry.startswith(f"@{source.kind}{{{source.key},\n")
        assert entry.count("{") == entry.count("}")
        assert {"author", "title", "year"} <= dict(source.fields).keys()
        assert dict(source.fields)["year"] in ALL[name].citation

    def test_says_what_it_is_and_when_to_take_it(self, name):
        preset = ALL[name]
        assert len(preset.about) > 60
        assert len(preset.when) > 10
        for parameter, meaning in preset.parameters:
            assert hasattr(preset.method, parameter)
            assert meaning


def test_every_citation_is_used():
    assert {preset.key for preset in ALL.values()} == set(CITATIONS)


def test_choices_replace_those_of_a_preset():
    solution = rd.solve(rd.load_scene("room"), "particle-tracing", numbers="sobol", order="depth-first", rays=1e5)
    assert solution.provenance["method"] == "continuous/local/depth-first/sobol"
