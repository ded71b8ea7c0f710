"""Rare events by active learning, and events of several limits."""

import sys

import numpy as np
import pytest
from computed import with_seed
from limit_states import PARTS, PLANE
from rare_studies import WEAR, branches, close, interval, linear, study
from scipy import integrate, stats

from uq.cli.rare_event import as_json
from uq.errors import InputError
from uq.explore.active_learning import EventEmulator
from uq.explore.limit_state import EventLimit, scale_of
from uq.explore.rare_events import rare_event
from uq.stats import regressions
from uq.stats.intervals import weighted_count_interval

S = np.sqrt(2.0)
LIFE = stats.lognorm(s=np.hypot(0.5, 0.2), scale=1e6)
CLIFF = stats.norm.sf(4.0) + stats.norm.sf(5.0)


def four_branches(beyond):
    """Return the exact probability that the demand of four branches exceeds a limit."""
    edge = 3.5 + beyond / S  # of the two planes, in (x1 - x2) / sqrt(2)
    bends, _ = integrate.quad(
        lambda t: 2 * stats.norm.sf(3.0 + beyond + 0.2 * t**2) * stats.norm.pdf(t),
        -edge,
        edge,
        epsabs=0,
    )
    return 2 * stats.norm.sf(edge) + bends


def covers(ds, truth):
    low, high = interval(ds)
    return low <= truth <= high


def cliff(inputs, seed):
    design = {"method": "monte-carlo", "samples": 64, "seed": seed}
    return study("limit_states:CLIFF", inputs, design=design)


@pytest.mark.parametrize(
    ("of", "output", "threshold", "below", "truth"),
    [
        (branches(), "sum", 4.753424, False, 1e-6),
        (branches(), "demand", 2.048386, False, four_branches(2.048386)),
        (study("exponential-wear", WEAR), "life", LIFE.ppf(1e-5), True, 1e-5),
        (study("exponential-wear", WEAR), "life", LIFE.isf(1e-4), False, 1e-4),
    ],
)
def test_known_probabilities_are_within_intervals_from_three_hundred_rows(
    of, output, threshold, below, truth
):
    ds = rare_event(of, output, threshold, below, method="active", workers=0)
    assert covers(ds, truth)
    assert interval(ds)[1] < 2 * interval(ds)[0]
    assert int(ds["rows"]) <= 300
    assert float(ds["misclassified"]) <= 0.03


@pytest.mark.parametrize(
    "method", ["subset", "importance", pytest.param("active", marks=pytest.mark.slow)]
)
def test_any_and_all_of_several_limits_have_closed_forms(method):
    both = [("sum", 4.753424, "above"), ("sum", -4.264891, "below")]
    ds = rare_event(branches(), any_of=both, method=method, workers=0)
    assert close(ds, 1.1e-5)
    assert ds.attrs["combination"] == "any" and ds.attrs["side"] == ["above", "below"]
    assert ds.attrs["output"] == ["sum", "sum"] and ds.attrs["units"] == ["1", "1"]
    # A slice of the sum, without its tail.
    within = [("sum", 4.264891, "above"), ("sum", 4.753424, "below")]
    if method != "importance":  # which stops at the first limit, from one of its sides
        ds = rare_event(branches(), all_of=within, method=method, workers=0)
        assert close(ds, 0.9e-5)
        assert as_json(ds)["combination"] == "all"


def test_all_of_several_limits_are_learnt_as_one_event():
    within = [("sum", 4.264891, "above"), ("sum", 4.753424, "below")]
    ds = rare_event(branches(), all_of=within, method="active", samples=150, workers=0)
    assert covers(ds, 0.9e-5) and int(ds["contradicted"]) <= 2


def test_limits_of_outputs_of_different_scale_are_one_event():
    of = study("exponential-wear", WEAR)
    early, late = LIFE.ppf(1e-4), LIFE.isf(1e-5)
    limits = [("life", early, "below"), ("life", late, "above")]
    for method in ("subset", "active"):
        ds = rare_event(of, any_of=limits, method=method, samples=200, workers=0)
        assert close(ds, 1.1e-4)


@pytest.mark.parametrize("below", [False, True])
def test_the_scale_of_a_skewed_life_is_logarithmic_and_keeps_the_side(below):
    life = np.append(LIFE.rvs(1000, random_state=1), [0.0, np.inf, 1e5, 1e5 * (1 + 1e-15)])
    margin = 1e5 - life if below else life - 1e5
    scale = scale_of(EventLimit("life", 1e5, below), margin[:1000])
    assert scale.logarithmic and scale(margin[:1000]).std() == pytest.approx(1.0)
    assert (np.sign(scale(margin)) == np.sign(margin)).all()
    assert not scale_of(EventLimit("sum", 1e5), 1e5 + stats.norm.rvs(size=99)).logarithmic


@pytest.mark.parametrize(
    ("of", "output", "threshold", "truth"),
    [
        (branches(), "step", 4.5, stats.norm.sf(4.75)),
        pytest.param(cliff(PLANE, 1), "stress", 5.0, CLIFF, marks=pytest.mark.slow),
    ],
    ids=("stair", "cliff"),
)
def test_a_jump_that_the_emulator_predicts_badly_is_corrected_by_rows(of, output, threshold, truth):
    ds = rare_event(of, output, threshold, method="active", samples=200, workers=0)
    assert covers(ds, truth)
    assert int(ds["contradicted"]) > 0
    assert interval(ds)[1] > 1.3 * interval(ds)[0]


@pytest.mark.parametrize("shift", [-0.1, 0.1])
def test_the_interval_holds_if_the_emulator_is_wrong(monkeypatch, shift):
    predicted = EventEmulator.__call__

    def wrong(self, u):
        probability, mean, most = predicted(self, u)
        return np.where(mean + shift > 0, 0.999, 1e-9), mean + shift, most + shift

    monkeypatch.setattr(EventEmulator, "__call__", wrong)
    ds = rare_event(branches(), "sum", 4.753424, method="active", samples=150, workers=0)
    assert int(ds["contradicted"]) > 3
    assert not 0.7e-6 < float(ds["emulated"]) < 1.4e-6
    assert covers(ds, 1e-6)


def test_rows_with_their_own_random_numbers_are_within_the_interval():
    of = study("limit_states:ROUGH", PLANE)
    truth, _ = integrate.quad(lambda noise: stats.norm.sf(4.5 - noise), -0.5, 0.5, epsabs=0)
    ds = rare_event(of, "rough", 4.5, method="active", samples=150, workers=0)
    assert covers(ds, truth)
    assert int(ds["contradicted"]) > 0


def test_an_event_out_of_reach_is_bounded_by_plain_rows():
    ds = rare_event(linear(), "y", 10.5, method="active", samples=150, workers=0)
    assert interval(ds) == (0.0, float(ds["hidden_high"]))
    assert 0.1 < float(ds["hidden_high"]) < 0.5
    assert "no row is beyond the threshold" in ds.attrs["notes"]


def test_rows_without_a_value_count_as_outside_and_have_a_bound():
    of = linear(settings={"fail_above": 0.97})
    ds = rare_event(of, "y", 9.0, method="active", samples=150, workers=0)
    assert int(ds["failed"]) > 0
    truth = 0.97**4 / (4 * 144)  # without the rows that fail
    assert covers(ds, truth) and float(ds["failed_high"]) > max(1 / 576, float(ds["high"]))


@pytest.mark.parametrize(
    ("of", "output", "threshold"),
    [(branches(), "sum", -30.0), (linear(settings={"fail_above": 0.97}), "y", -5.0)],
    ids=("certain", "certain where rows do not fail"),
)
def test_neither_a_probability_nor_its_interval_exceeds_one(of, output, threshold):
    ds = rare_event(of, output, threshold, method="active", samples=150, workers=0)
    assert 0.8 < interval(ds)[0] <= float(ds["probability"]) <= interval(ds)[1] <= 1
    assert float(ds["emulated"]) <= 1
    assert not float(ds["failed_high"]) > 1


def test_the_bits_do_not_depend_on_workers():
    first, second = (
        rare_event(branches(), "sum", 4.0, method="active", samples=100, workers=workers)
        for workers in (0, 2)
    )
    assert first.identical(second)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"replicates": 2}, "method 'active' has no replicates"),
        ({"samples": 99}, "samples must be at least 100: 99"),
        ({"threshold": None}, "give an output and a threshold"),
        ({"any_of": [("y", 9.0, "above")] * 2}, "give an output and a threshold"),
        ({"output": None, "threshold": None, "all_of": [("y", 9.0, "above")]}, "at least two"),
        (
            {"output": None, "threshold": None, "any_of": [("y", 9.0, "over")] * 2},
            "'above' or 'below', not 'over'",
        ),
        (
            {"output": None, "threshold": None, "any_of": [("y", 9.0, "above"), ("z", 1, "above")]},
            "no such output",
        ),
    ],
)
def test_mistakes_are_said_in_a_line(arguments, words):
    given = {"study": linear(), "output": "y", "threshold": 9.0, "method": "active"}
    with pytest.raises(InputError, match=words):
        rare_event(**(given | arguments))


def test_without_openturns_there_is_a_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "openturns", None)
    with pytest.raises(InputError, match=r"pip install 'vibrolife\[reliability\]'"):
        rare_event(linear(), "y", 9.0, method="active", workers=0)


def test_a_process_that_cannot_be_factorised_gets_a_nugget(monkeypatch):
    fitter, nuggets = regressions._process_fitter, []

    def refusing(z, y, fit):
        nuggets.append(fit["nugget"])
        if fit["nugget"] < 1e-6:
            raise RuntimeError("no eigenvalue")
        return fitter(z, y, fit)

    monkeypatch.setattr(regressions, "_process_fitter", refusing)
    ds = rare_event(branches(), "sum", 3.0, method="active", samples=100, workers=0)
    assert min(nuggets) < 1e-6 and covers(ds, stats.norm.sf(3.0))


def test_a_weighted_count_has_the_limits_of_poisson():
    rng = np.random.default_rng(2)
    assert weighted_count_interval(np.empty(0), 1.0)[1] == pytest.approx(-np.log(0.025))
    assert weighted_count_interval(np.ones(5), 1.0) == pytest.approx((1.6235, 11.668), rel=1e-4)
    hits = 0
    for counts in rng.poisson([3.0, 1.0], (2000, 2)):
        weights = np.repeat([1.0, 2.0], counts)
        low, high = weighted_count_interval(weights, 2.0)
        hits += low <= 5.0 <= high
    assert hits > 0.95 * 2000


def test_a_covariance_whose_eigenvalues_are_alike_is_factorised():
    """OpenTURNS gave up its search for the largest one, and the event had no estimate."""
    estimate = rare_event(with_seed(cliff(PLANE, 1), 28), "stress", 5.0, method="active", workers=0)
    assert covers(estimate, CLIFF)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("of", "output", "threshold", "truth"),
    [
        (branches(), "demand", 2.048386, four_branches(2.048386)),
        (branches(), "step", 4.5, stats.norm.sf(4.75)),
        (cliff(PLANE, 1), "stress", 5.0, CLIFF),
        (study("oscillator", PARTS), "excess", 0.0, 9.09e-6),
        (linear(), "y", 10.0 - 576e-6**0.25, 1e-6),
    ],
    ids=("branches", "stair", "cliff", "oscillator", "corner"),
)
def test_intervals_of_active_learning_cover_over_seeds(of, output, threshold, truth):
    covered = [
        covers(
            rare_event(with_seed(of, seed), output, threshold, method="active", workers=0), truth
        )
        for seed in range(40)
    ]
    assert np.mean(covered) >= 0.9
