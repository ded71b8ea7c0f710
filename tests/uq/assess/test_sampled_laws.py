"""Laws as stated, and as the rows have made of them."""

import numpy as np
import pytest
from computed import computed, study_of
from input_studies import BELL, UNIFORM, tables
from scipy import stats

from uq import plots
from uq.assess.sampled_laws import compare
from uq.errors import InputError
from uq.sampling.laws import law_of


def test_the_distance_is_that_of_kolmogorov_and_smirnov():
    law = law_of(BELL)
    x = np.random.default_rng(1).normal(0.52, 0.05, 500)
    exact = stats.kstest(x, stats.norm(0.5, 0.05).cdf).statistic
    assert compare(law, x).distance == pytest.approx(exact, rel=1e-12)
    die = law_of({"distribution": "integer-range", "lower": 1, "upper": 6})
    assert compare(die, np.repeat(np.arange(1.0, 7.0), 10)).distance == pytest.approx(0)
    assert compare(die, np.ones(10)).distance == pytest.approx(5 / 6)


def test_check_shows_what_the_rows_make_of_the_laws(uq, write_study):
    more = """
        x4 = {equals = "x1"}
        [dependence]
        parameters = ["x1", "x2"]
        rank_correlation = [[1.0, 0.5], [0.5, 1.0]]
    """
    path = write_study("linear", "sobol", 1024, more=more)
    shown = uq("check", path).out
    assert "equals x1" in shown and "this design can provide delta, pawn, quantile," in shown
    lines = [line.split() for line in shown.splitlines()]
    assert ["x1", "stated", "0.14", "0.5", "0.86"] in lines
    (pair,) = [line for line in lines if line[:2] == ["x1,", "x2"]]
    assert float(pair[2]) == 0.5 and float(pair[3]) == pytest.approx(0.5, abs=0.01)
    trajectories = write_study("linear", "morris", 4, name="steps")
    assert "do not follow these laws" in uq("check", trajectories).out


def test_a_figure_shows_each_input_as_stated_and_as_the_rows_have_it():
    entries = {"x1": BELL, "x2": UNIFORM | {"times": "x1"}, "x3": {"equals": "x1"}}
    figure = plots.inputs(computed(study_of(tables(entries, "sobol", 4096))))
    assert [axes.get_xlabel() for axes in figure.axes] == [
        "Independent input ($x_{1}$)",
        "Independent input: factor on x1",
    ]
    for axes in figure.axes:
        sampled, stated = (  # densities: the area is 1
            patch.get_data().values * np.diff(patch.get_data().edges) for patch in axes.patches
        )
        np.testing.assert_allclose(sampled, stated, atol=2e-3)
        assert stated.sum() == pytest.approx(1, abs=1e-3)
    bell = figure.axes[0].patches[1].get_data()
    law = np.diff(stats.norm(0.5, 0.05).cdf(bell.edges)) / np.diff(bell.edges)
    np.testing.assert_allclose(bell.values, law, rtol=1e-6)
    (alone,) = plots.inputs(computed(study_of(tables(entries, "sobol", 64))), names=["x2"]).axes
    assert alone.get_xlabel() == "Independent input: factor on x1"
    with pytest.raises(InputError, match="'morris' design do not follow the laws"):
        plots.inputs(computed(study_of(tables({"x1": BELL}, "morris", 4))))
