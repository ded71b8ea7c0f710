"""Inputs that only scale a life are integrated exactly, and intervals still hold the truth."""

import json

import numpy as np
import pytest
from computed import computed, summarised, with_seed
from scaled_studies import NORMAL, WHOLE, lognormal, populated, scaled_study
from scipy import special

from uq.assess.comparison import compare
from uq.assess.integrated_inputs import elements_with_laws, integrated
from uq.assess.row_inputs import inputs_of
from uq.assess.scale_laws import IndependentScale
from uq.assess.summary_table import summary
from uq.assess.survival import survival
from uq.assess.weighted_mixture import WeightedMixture
from uq.result.elements import independent_rows
from uq.result.result import Result
from uq.sampling.laws import law_of
from uq.sampling.log_sums import LogTerm, law_of_sum

EVERYWHERE = (-np.inf, np.inf)


@pytest.mark.parametrize("sigmas", [(0.5, 0.1), (0.3, 0.3), (1.0, 0.01), (0.5, 0.3, 0.2)])
def test_a_sum_of_normal_logarithms_is_accurate(sigmas):
    exponents = (-1.0, 1.0, 2.0)
    terms = [
        LogTerm(law_of(lognormal(sigma)), EVERYWHERE, exponent)
        for sigma, exponent in zip(sigmas, exponents, strict=False)
    ]
    law = law_of_sum(terms)
    spread = np.sqrt(sum((s * e) ** 2 for s, e in zip(sigmas, exponents, strict=False)))
    y = np.linspace(-9, 9, 401) * spread
    assert np.abs(law.below(y) - special.ndtr(y / spread)).max() < 1e-10


def test_a_sum_of_uniform_logarithms_is_a_trapezium():
    wide, narrow = np.log(10), np.log(3)
    terms = [
        LogTerm(
            law_of({"distribution": "loguniform", "lower": 1.0, "upper": 10.0}), EVERYWHERE, -1
        ),
        LogTerm(law_of({"distribution": "loguniform", "lower": 1.0, "upper": 3.0}), EVERYWHERE, 1),
    ]
    y = np.linspace(-wide - 0.1, narrow + 0.1, 401)

    def ramp(v):
        return np.clip(v + wide, 0, None) ** 2 / 2

    truth = (ramp(y) - ramp(y - wide) - ramp(y - narrow) + ramp(y - wide - narrow)) / wide / narrow
    assert np.abs(law_of_sum(terms).below(y) - truth).max() < 1e-10


SCALES = {
    "lognormal": [(lognormal(0.5), 1.0)],
    "lognormal, divided": [(lognormal(0.5), -2.0)],
    "normal": [({"distribution": "normal", "mean": 2.5, "sd": 0.25}, 1.0)],
    "truncated below": [(lognormal(0.5, truncate=[0.9, 5.0]), 1.0)],
    "truncated above": [(lognormal(0.5, truncate=[1e-3, 1.1]), -1.0)],
    "uniform": [({"distribution": "uniform", "lower": 0.5, "upper": 2.0}, 1.0)],
    "weibull": [({"distribution": "weibull", "shape": 3.0, "scale": 2.0}, 1.0)],
    "product": [(lognormal(0.5), 1.0), (lognormal(0.3), -1.0)],
}


@pytest.mark.parametrize("name", SCALES)
def test_at_each_time_a_row_outlives_it_as_if_asked_alone(name):
    terms = [LogTerm(law_of(law), (0.0, np.inf), exponent) for law, exponent in SCALES[name]]
    random = np.random.default_rng(0)
    lives = 10.0 ** random.uniform(0, 12, 40_000)
    lives[:3] = np.nan, np.inf, 0.0
    law = IndependentScale(("a",), law_of_sum(terms), random.normal(size=len(lives)))
    times = np.array([1e-5, 10.0, 1e6, 1e8, 1e20])
    for time, above in zip(times, law.above_each(lives, times), strict=True):
        alone = np.where(np.isnan(lives), 0.0, 1 - law.below(lives, time))
        assert np.array_equal(above, alone)


def by_copula(name, **options):
    """Return a table [dependence] of `a`, which only scales, and `z`."""
    ranks = {"parameters": ["a", "z"], "rank_correlation": [[1.0, 0.7], [0.7, 1.0]]}
    return {"dependence": ranks | {"copula": name, **options}}


CASES = {
    "one": (WHOLE, {}, ("a",)),
    "signs mixed": (
        {
            "a": lognormal(0.5),
            "b": lognormal(0.2, 2.0),
            "c": {"distribution": "loguniform", "lower": 1.0, "upper": 9.0},
            "z": NORMAL,
        },
        {},
        ("a", "b", "c"),
    ),
    "truncated": (WHOLE | {"a": lognormal(0.5, truncate=[0.7, 1.2])}, {}, ("a",)),
    "multiple": (
        WHOLE
        | {"a": {"distribution": "uniform", "lower": 0.5, "upper": 2.0, "times": "b"}}
        | {"b": lognormal(0.01)},
        {},
        ("a",),
    ),
    "tied": (WHOLE | {"c": {"equals": "a"}}, {}, ("a",)),
    "correlated": (
        WHOLE,
        {"dependence": {"parameters": ["a", "z"], "rank_correlation": [[1.0, 0.7], [0.7, 1.0]]}},
        ("a",),
    ),
    "against": (
        {"b": lognormal(0.5), "z": NORMAL},
        {"dependence": {"parameters": ["z", "b"], "rank_correlation": [[1.0, 0.8], [0.8, 1.0]]}},
        ("b",),
    ),
    "student": (WHOLE, by_copula("student", degrees_of_freedom=3.0), ("a",)),
    "clayton": (WHOLE, by_copula("clayton"), ("a",)),
    "survival clayton": (WHOLE, by_copula("clayton", survival=True), ("a",)),
    "gumbel": (WHOLE, by_copula("gumbel"), ("a",)),
    "frank": (WHOLE, by_copula("frank"), ("a",)),
    "listed": (
        WHOLE | {"c": {"distribution": "discrete-choice", "values": [1.0, 4.0]}},
        {},
        ("a",),
    ),
    "never": (WHOLE, {"settings": {"never_above": 0.5}}, ("a",)),
}


@pytest.mark.parametrize(
    "case",
    [pytest.param(case, marks=[pytest.mark.slow] * (case == "signs mixed")) for case in CASES],
)
def test_a_few_rows_say_what_very_many_say(case):
    """The mean law of the rows is the distribution of many plain rows."""
    uncertain, tables, wanted = CASES[case]
    rows, _ = populated(computed(scaled_study(uncertain, samples=2000, **tables)))
    assert rows.element.law.inputs == wanted
    many = computed(scaled_study(uncertain, {"seed": 4}, samples=60_000, **tables))["life"].values
    for p in (0.05, 0.4):
        time = np.quantile(many, p, method="inverted_cdf")
        probability = rows.below(time)
        assert abs(probability.value - p) < (probability.high - probability.low) + 4 * np.sqrt(
            p * (1 - p) / 60_000
        )
        plain = WeightedMixture(rows.element.plain).below(time)
        assert probability.high - probability.low < 0.9 * (plain.high - plain.low)
        assert rows.quantile(probability.value).value == pytest.approx(time, rel=1e-9)


@pytest.mark.parametrize("copula", [{}, {"copula": "gumbel"}, {"copula": "clayton"}], ids=str)
def test_the_law_of_a_row_is_the_conditional_distribution(copula):
    """Rows with the same z: the life of each is its law, correlation and all."""
    ranks = [[1.0, 0.6], [0.6, 1.0]]
    tables = {"dependence": {"parameters": ["z", "a"], "rank_correlation": ranks} | copula}
    element = populated(computed(scaled_study(WHOLE, samples=20_000, **tables)))[0].element
    shares = element.law.below(element.values, 1.5)
    hits = element.plain.below(1.5)
    for part in np.array_split(np.argsort(shares), 8):
        p = shares[part].mean()
        assert abs(hits[part].mean() - p) < 4 * np.sqrt(p * (1 - p) / len(part)) + 1e-9


def test_what_cannot_be_integrated_is_not_and_says_why():
    censored = computed(scaled_study(WHOLE, settings={"horizon": 2.0}))
    rows, why = populated(censored)
    assert rows.element.law is None and "censored, which gives bounds only" in why
    rows, why = populated(computed(scaled_study(WHOLE | {"z": {"equals": "a"}})))
    assert rows.element.law is None and "z has the same value" in why
    leader = {"z": {"distribution": "uniform", "lower": 0.5, "upper": 2.0}, "a": {"equals": "z"}}
    rows, why = populated(computed(scaled_study(leader)))
    assert rows.element.law is None and why == "z not integrated: it does more than scale lives"
    beside = WHOLE | {"b": lognormal(0.01, times="a")}
    rows, why = populated(computed(scaled_study(beside)))
    assert rows.element.law.inputs == ("b",) and "b is a multiple of it" in why
    assert "integrated" not in summarised(censored)["outputs"]["life"]


def test_bounds_condition_the_law():
    """A law cut off at the parameter's bounds is integrated as it was drawn."""
    inputs = {"b": {"distribution": "loguniform", "lower": 0.01, "upper": 50.0}, "z": NORMAL}
    rows, _ = populated(computed(scaled_study(inputs)))
    assert rows.element.law.term.breaks == pytest.approx(-2 * np.log([50.0, 0.01]), rel=1e-9)


def test_everything_that_reads_statistics_follows():
    ds = computed(scaled_study(WHOLE))
    integrated_statistics, plain = (
        summarised(ds)["outputs"]["life"],
        summarised(ds, plain=True)["outputs"]["life"],
    )
    assert (
        integrated_statistics["integrated"]["inputs"] == ["a"]
        and integrated_statistics["integrated"]["worth"] > 1.5
    )
    assert "integrated" not in plain
    both = [
        statistics_of_kind["thresholds"]["1.0"]["below"]
        for statistics_of_kind in (integrated_statistics, plain)
    ]
    assert both[0]["high"] - both[0]["low"] < 0.8 * (both[1]["high"] - both[1]["low"])
    line = summary(ds).loc["life"]
    assert (
        line["P(<1.0)"] == both[0]["value"]
        and line["B10"] == integrated_statistics["b_lives"]["B10"]["value"]
    )
    assert summary(ds, plain=True).loc["life", "P(<1.0)"] == both[1]["value"]
    curve = survival(ds, "life").sel(time=line["q0.5"], method="ffill")
    assert float(curve["low"]) < 0.5 < float(curve["high"])
    other = computed(with_seed(scaled_study(WHOLE), 8))
    table = compare(ds, other).loc[("life", "P(<1.0)")]
    assert table["first"] == both[0]["value"] and table["low"] < 0 < table["high"]


def test_paired_rows_of_two_studies_are_compared_by_their_laws():
    ds = computed(scaled_study(WHOLE))
    wider = computed(scaled_study(WHOLE | {"a": lognormal(0.6)}))
    table = compare(ds, wider).loc["life"]
    alone = compare(ds, computed(with_seed(scaled_study(WHOLE | {"a": lognormal(0.6)}), 8)))
    width = (table["high"] - table["low"]).loc["P(<1.0)"]
    assert width < 0.5 * np.ptp(alone.loc[("life", "P(<1.0)"), ["low", "high"]])
    assert json.dumps(summarised(wider))


def test_each_level_is_integrated_by_itself():
    """What is shared, integrated after what is own, gives what both give at once."""
    shared = lognormal(0.3, level="shared")
    ds = computed(scaled_study(WHOLE | {"b": shared}, {"units": 4, "repeats": 1}, samples=50))
    rows = independent_rows(ds)
    element = next(elements_with_laws(Result(rows), ["life"]))
    inputs = inputs_of(Result(rows))
    unit_part, world = (
        integrated(Result(rows), element.declared, inputs, {level})[0]
        for level in ("own", "shared")
    )
    assert (unit_part.inputs, world.inputs) == (("a",), ("b",))
    z, weight = np.polynomial.hermite_e.hermegauss(60)
    probability = sum(
        w * unit_part.below(element.values * np.exp(shifts), 0.7)
        for w, shifts in zip(weight / weight.sum(), world.log_life_shifts(z), strict=True)
    )
    assert probability == pytest.approx(element.below(0.7), abs=1e-10)


EXPONENTS = {"a": 1.0, "b": -2.0, "c": 0.5}


PLACES = {
    "own": {"a": "own"},
    "shared": {"b": "shared"},
    "chance": {"c": "chance"},
    "own and shared": {"a": "own", "b": "shared"},
    "all": {"a": "own", "b": "shared", "c": "chance"},
}


@pytest.mark.parametrize("levels", list(PLACES.values()), ids=list(PLACES))
def test_every_level_is_integrated_in_probabilities_quantiles_and_curves(levels):
    inputs = {name: lognormal(0.3, level=level) for name, level in levels.items()}
    design = {"units": 3, "repeats": 2}
    ds = computed(scaled_study(inputs | {"z": NORMAL}, design, samples=60))
    rest = np.exp(ds["z"].values / 2)
    spread = 0.3 * np.hypot.reduce([EXPONENTS[name] for name in levels])

    def below(time):
        return special.ndtr(np.log(time / rest) / spread).mean()

    line_of_summary, line = summary(ds).loc["life"], survival(ds, "life")
    assert line_of_summary["P(<1.0)"] == pytest.approx(below(1.0), abs=1e-9)
    assert below(line_of_summary["B10"]) == pytest.approx(0.1, abs=1e-9)
    assert below(line_of_summary["q0.5"]) == pytest.approx(0.5, abs=1e-9)
    assert set(line.attrs["integrated"].split()) == set(levels)
    time = float(line["time"][40])
    assert float(line["survival"][40]) == pytest.approx(1 - below(time), abs=1e-9)


@pytest.mark.parametrize(
    "case",
    [
        "correlated",
        *(
            pytest.param(case, marks=pytest.mark.slow)
            for case in ("one", "truncated", "multiple", "against")
        ),
    ],
)
def test_means_and_variances_of_logarithms_are_those_of_the_law(case):
    """By quadrature of the probability that the life of each row is shorter."""
    inputs, tables, _ = CASES[case]
    ds = computed(scaled_study(inputs, samples=8, **tables))
    law = next(elements_with_laws(Result(ds), ["life"])).law
    mean, variance = law.moments
    logs = np.log(ds["life"].values)
    y = np.linspace(-8, 8, 16_001)
    steps = np.diff([law.below(np.exp(logs), np.exp(value)) for value in y], axis=0)
    middle = (y[1:] + y[:-1]) / 2
    assert mean + logs == pytest.approx(middle @ steps, abs=1e-6)
    assert variance == pytest.approx(middle**2 @ steps - (middle @ steps) ** 2, abs=1e-6)
