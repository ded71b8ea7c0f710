"""Numbers in sentences and tables are no more exact than they are known."""

from math import inf, nan

import pytest

from uq.indices.groups import MU, MU_STAR
from uq.indices.index import S1, ST
from uq.sampling.laws import law_of
from uq.stats.estimate import Estimate, interval_text, rounded_text, share_text, value_text
from uq.text.numbers import (
    capitalized,
    counted,
    duration,
    estimated,
    law,
    law_in_unit,
    percent,
    percent_interval,
    quantity,
)
from uq.text.quantities import read_quantity
from uq.text.units import ReadableUnit


@pytest.mark.parametrize(
    ("stated", "words"),
    [
        ({"distribution": "normal", "mean": 2.5e-4, "sd": 2.5e-5}, "normal: mean 250 µm, sd 25 µm"),
        (
            {"distribution": "lognormal", "mean": 2.5e-4, "cv": 0.15, "truncate": [1e-4, 3e-4]},
            "lognormal: truncate 100 to 300 µm, mean 250 µm, cv 0.15",
        ),
        (
            {"distribution": "discrete-choice", "values": [1e-4, 2e-4], "weights": [1, 2]},
            "discrete-choice: values 100, 200 µm, weights 1, 2",
        ),
        (
            {"distribution": "histogram", "edges": [1e-4, 2e-4, 4e-4], "counts": [3, 1]},
            "histogram: edges 100, 200, 400 µm, counts 3, 1",
        ),
    ],
    ids=lambda value: value["distribution"] if isinstance(value, dict) else "",
)
def test_a_law_is_in_the_unit_of_its_input(stated, words):
    assert law_in_unit(law_of(stated), ReadableUnit("µm", 1e-6)) == words


@pytest.mark.parametrize(
    ("value", "low", "high", "text"),
    [
        (2.0268, 1.9863, 2.0841, ("2.03", "1.99 to 2.08")),
        (13607.0, 13500.0, 13710.0, ("13610", "13500 to 13710")),
        (-0.0425, -0.0457, 0.0001, ("-0.0425", "-0.0457 to 0.0001")),
        (-1.03, -1.21, -0.88, ("-1.03", "-1.21 to -0.88")),
        (68.2, 41.2, 81.4, ("68.2", "41.2 to 81.4")),
        (648.1, 441.18, inf, ("648", "441 to never")),
        (155.927, 155.915, 155.936, ("155.927", "155.915 to 155.936")),
        (0.0, 0.0, 0.0006, ("0", "0 to 0.000600")),
        (1.42e-4, 1.39e-4, 1.45e-4, ("0.000142", "0.000139 to 0.000145")),
        (0.012345, nan, nan, ("0.0123", "")),
        (2.0, 2.0, 2.0, ("2.00", "2.00 to 2.00")),
        (nan, 1.0, 2.0, ("-", "1.00 to 2.00")),
    ],
)
def test_an_estimate_has_three_digits_or_those_of_a_narrow_interval(value, low, high, text):
    assert rounded_text(Estimate(value, low, high)) == text


def test_what_is_zero_has_no_sign_and_small_shares_have_digits():
    assert S1.text(-0.0002) == "0.000"
    assert MU.text(-0.0002) == "-0.0002"
    assert [percent(share) for share in (0.0, 1 / 6000, 0.769, 0.9999, 0.999962, 1.0)] == [
        "0 %",
        "0.017 %",
        "76.9 %",
        "99.99 %",
        "99.996 %",
        "100 %",
    ]


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (None, ""),
        (3599.0, ""),
        (7200.0, "2 hours"),
        (-7200.0, "-2 hours"),
        (86400.0 * 3, "3 days"),
        (86400.0 * 365.25 * 40, "40 years"),
        (float("inf"), ""),
    ],
)
def test_times_in_words(seconds, words):
    assert duration(seconds) == words


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (Estimate(nan, 3600.0, 7200.0), "1 to 2"),
        (Estimate(nan, 3600.0, inf), "1 to never"),
        (Estimate(nan, 3600.0, inf, beyond=("high",)), "1 to beyond the horizon"),
        (Estimate(nan, inf, inf), ""),
        (Estimate(inf), ""),
        (Estimate(nan, nan, 7200.0), "- to 2"),
        (Estimate(), ""),
    ],
)
def test_each_end_of_an_interval_is_a_number_or_says_why_not(estimate, text):
    assert interval_text(estimate, per=3600.0) == text


def test_a_number_that_is_none_says_why():
    assert value_text(Estimate(7200.0), per=3600.0) == "2"
    assert value_text(Estimate(inf)) == "never"
    assert value_text(Estimate(inf, beyond=("value",))) == "beyond the horizon"
    assert value_text(Estimate(nan, inf)) == "-"


def test_effects_have_digits_whatever_their_unit():
    assert MU_STAR.text(1234.5) == "1.23e+03"
    assert ST.text(0.12345) == "0.123"


def test_a_law_is_written_by_its_arguments_alone():
    given = {"distribution": "normal", "mean": 1.0, "sd": 0.1, "source": "a book", "times": "x"}
    assert law(law_of(given)) == "normal(mean = 1.0, sd = 0.1)"
    drawn = {"distribution": "empirical", "values": [1.0, 2.0]}
    assert law(law_of(drawn)) == "empirical(values = [1.0, 2.0])"


def test_what_is_estimated_is_compared_in_a_unit_that_people_use():
    assert estimated("P(>0.20943951023931953)", "rad") == "P(> 12°)"
    assert estimated("P(<86400.0)", "s") == "P(< 24 hours)"
    assert estimated("quantile 0.5", "s") == "quantile 0.5"
    assert estimated("P(>0.20943951023931953)", "rad", "|psi|") == "P(|psi| > 12°)"
    name = "P(life[depth=0.00025,site=a<b]<3e-05)"
    assert estimated(name, "s") == "P(life[depth=0.00025,site=a<b] < 30 µs)"
    assert estimated("P(regime=slow)", "1") == "P(regime=slow)"


def test_a_threshold_is_shown_in_the_unit_of_the_study():
    asked = [read_quantity("1 day"), read_quantity("1e3 mrad")]
    assert estimated("P(<86400.0)", "s", asked=asked) == "P(< 1 day)"
    assert estimated("P(>1.0)", "rad", asked=asked) == "P(> 1e3 mrad)"


def test_a_power_of_ten_is_multiplied():
    assert quantity(3.62e-15, "m2 N-1") == "3.62 × 10⁻¹⁵ m² N⁻¹"
    assert quantity(2.5e-4, "m") == "250 µm" and quantity(3.0, "1") == "3"


def test_a_life_that_never_ends_at_the_low_end_has_no_interval():
    assert interval_text(Estimate(low=inf)) == ""
    assert interval_text(Estimate(low=2.0, high=inf)) == "2 to never"


@pytest.mark.parametrize(
    ("text", "title"),
    [
        ("contact stiffness", "Contact stiffness"),
        ("a stiffer stop", "A stiffer stop"),
        ("k: more shortens it", "k: more shortens it"),
        ("x1 and x2", "x1 and x2"),
        ("k_c", "k_c"),
    ],
)
def test_a_name_that_is_a_symbol_keeps_its_case_at_the_head_of_a_sentence(text, title):
    assert capitalized(text) == title


def test_what_is_counted_is_singular_where_it_is_one():
    assert [counted(n, "row") for n in (0, 1, 2)] == ["0 rows", "1 row", "2 rows"]
    assert counted(1, "life is", "lives are") == "1 life is"
    assert counted(3, "life is", "lives are") == "3 lives are"


def test_an_interval_whose_ends_read_alike_is_none():
    assert percent_interval(0.5, 0.625) == "50.0 to 62.5 %"
    assert percent_interval(1.0, 1.0) == "within these digits"
    assert percent_interval(0.0, 1e-4) == "0 to 0.01 %"
    assert share_text(Estimate(1.0, 1.0, 1.0)) == "100 % (within these digits)"
    assert share_text(Estimate(0.138, 0.117, 0.162)) == "13.8 % (95 % interval 11.7 to 16.2 %)"
