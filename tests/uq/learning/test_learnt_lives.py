"""Lives of an inspected unit: the law of each row, given the inspections, against closed form."""

import numpy as np
import pytest
from learnt_studies import DEPTH, exactly, measured, wear
from scipy import stats

from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.row_inputs import inputs_of
from uq.assess.scale_laws import ConditionalScale, NormalGiven, PosteriorScale
from uq.assess.weighted_mixture import WeightedMixture
from uq.explore.updating import update
from uq.learning.inspections import read_tables
from uq.learning.integrated_input import dependent_outputs
from uq.learning.posterior import posterior
from uq.learning.posterior_inputs import inputs_learnt
from uq.learning.posterior_result import as_unit
from uq.learning.remaining_life import remaining
from uq.result.result import Result

SEEN = 1.5e6


def element_of(told, samples=2000):
    unit = as_unit(update(wear(samples=samples), told), "A")
    return next(elements_with_laws(Result(unit), ["life"])), unit["rate"].values


def truncated(rate):
    """Return the law of the depth of a unit with some rate that ran at `SEEN`, as P(T < t)."""
    law = stats.lognorm(DEPTH[1], scale=DEPTH[0])
    gone = law.cdf(SEEN * rate)
    return lambda time: np.maximum(law.cdf(time * rate) - gone, 0) / (1 - gone)


@pytest.mark.parametrize("time", [1.55e6, 1.6e6, 2e6, 3e6])
def test_each_row_is_the_law_of_its_life_given_that_it_runs(time):
    told = {"unit": "A", "output": "life", "kind": "survived", "time": SEEN}
    element, rate = element_of([told])
    assert element.law.inputs == ("depth",)
    counts = element.weights > 0.01
    exact, probability = truncated(rate)(time), element.below(time)
    assert np.abs(probability - exact)[counts].max() < 2e-3
    assert np.average(probability - exact, weights=element.weights) == pytest.approx(0, abs=4e-4)


def test_a_life_known_within_a_narrow_window_is_that_life():
    """Where hardly a value of the depth agrees in a row, rows count as if all values were tried."""
    told = [
        {"unit": "A", "output": "life", "kind": "survived", "time": 4e5},
        {"unit": "A", "output": "life", "kind": "ended", "time": 4e5 * 1.002},
    ]
    unit_posterior = posterior(Result(wear(samples=6000)), read_tables(told)).units["A"]
    depth, weights = np.log(unit_posterior.scale), unit_posterior.weights.weights
    mean, cov = exactly([4e5 * 1.001], cv=1e-9)
    center = np.average(depth, weights=weights)
    sd = np.average((depth - center) ** 2, weights=weights) ** 0.5
    assert center == pytest.approx(mean[1], abs=0.1 * cov[1, 1] ** 0.5)
    assert sd == pytest.approx(cov[1, 1] ** 0.5, rel=0.06)


def test_a_unit_seen_running_has_not_ended_before():
    told = {"unit": "A", "output": "life", "kind": "survived", "time": SEEN}
    ds = update(wear(samples=2000), [told])
    unit = next(life for life in remaining(Result(ds), [SEEN, 2e6]) if life.unit == "A")
    assert unit.runs.value == 1.0 and unit.by[SEEN].value == 0.0
    assert unit.life[0.05].value < unit.life[0.5].value < unit.life[0.95].value


@pytest.mark.parametrize("time", [4.5e5, 5e5, 5.2e5, 6e5])
def test_each_row_is_the_law_of_its_life_given_a_measurement(time):
    """The depth of a row has a lognormal law, given its rate and the life measured."""
    element, rate = element_of(measured(5e5))
    error, prior = np.log1p(0.1**2), DEPTH[1] ** 2
    sd = (error * prior / (error + prior)) ** 0.5
    mean = (np.log(DEPTH[0]) / prior + np.log(5e5 * rate) / error) * sd**2
    exact = stats.norm.cdf((np.log(time * rate) - mean) / sd)
    difference = element.below(time) - exact
    assert np.average(difference, weights=element.weights) == pytest.approx(0, abs=2e-4)


@pytest.mark.parametrize("exponent", [-1.0, 2.0])
def test_without_inspections_it_is_the_law_of_the_study(exponent):
    inputs = inputs_of(Result(wear(samples=50)))
    of = ("rate",), inputs.laws["rate"], inputs.bounds["rate"], exponent, inputs.values["rate"]
    lives = np.append(np.linspace(5e5, 2e6, 48), [np.inf, np.nan])
    scale = PosteriorScale(*of, np.tile(np.linspace(-6, 6, 97), (50, 1)))
    study = ConditionalScale(*of, NormalGiven(np.zeros(50), 1.0))
    for time in (4e5, 1e6, 3e6):
        np.testing.assert_allclose(scale.below(lives, time), study.below(lives, time), atol=1e-8)


def test_an_input_on_which_other_outputs_depend_is_not_integrated():
    """They would keep the values for the input as drawn: here the life, as another output."""
    rows, told = wear(samples=500).copy(), read_tables(measured(5e5))
    rows["life_error"] = 1e-3 * rows["life"]
    kept = {name: attribute for name, attribute in rows["life"].attrs.items() if name != "scales"}
    rows["life_error"].attrs = kept
    assert posterior(Result(rows), told).scale.name == "depth"  # errors scale with their lives
    rows["power"] = rows["life"] * 2
    rows["power"].attrs = kept
    assert list(dependent_outputs(Result(rows), "depth")) == ["power"]
    learned = posterior(Result(rows), told)
    assert learned.scale is None
    (why,) = learned.not_integrated
    assert why == "depth is not integrated: power depends on it otherwise."


def test_a_unit_never_inspected_runs_on_where_all_is_shared_with_one_that_does():
    rows = wear(samples=2000, rate="shared", depth="shared", units=2)
    told = {"unit": "A", "output": "life", "kind": "survived", "time": 7e5}
    (anyone, inspected) = remaining(Result(update(rows, [told])), [1e6])
    assert anyone.runs.value == pytest.approx(1, abs=1e-4)
    assert anyone.by[1e6].value == pytest.approx(inspected.by[1e6].value, abs=0.02)


def test_the_mean_of_an_integrated_input_scatters_as_its_interval_says():
    """Values drawn as evenly as its law would seem to scatter three times as much."""
    lives = measured(6e5, 1e6, 1.2e6, cv=0.3)
    means = [
        next(
            input_.posterior.mean
            for input_ in inputs_learnt(Result(ds))
            if input_.name == "depth[unit=A]"
        )
        for seed in range(20)
        for ds in [update(wear(samples=300, seed=seed, rate="shared", units=3), lives)]
    ]
    scatter = np.std([mean.value for mean in means], ddof=1)
    width = np.mean([mean.high - mean.low for mean in means]) / 3.92
    assert 0.6 < width / scatter < 1.6


def test_no_end_of_an_interval_lies_before_a_time_that_the_unit_outlived():
    rows = wear(samples=200).copy()
    rows["life"].attrs.pop("scales")
    told = {"unit": "A", "output": "life", "kind": "survived", "time": SEEN}
    unit = as_unit(update(rows, [told]), "A")
    (element,) = elements_with_laws(Result(unit), ["life"])
    assert element.law is None
    quantile = WeightedMixture(element).quantile(0.1)
    assert SEEN <= quantile.low <= quantile.value
    assert not WeightedMixture(element).quantile(0.01).low < SEEN  # too few rows for an end
