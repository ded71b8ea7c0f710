"""What the scripts of a page compute, one by one, against Python."""

import json

import numpy as np
import pytest
from report_scripts import scripts
from scipy import special

from uq.render.html.tolerances import KNOWN
from uq.sampling.laws import LAWS, law_of
from uq.sampling.log_sums import LogTerm, law_of_sum
from uq.sampling.truncation import cdf_within, log_density_between
from uq.stats.importance_weights import refusal, tail_shape
from uq.stats.weighted_means import weighted_share

ARGUMENTS = {
    "normal": {"mean": 3.0, "sd": 0.4},
    "truncated-normal": {"mean": 3.0, "sd": 0.9, "lower": 1.0, "upper": 4.0},
    "lognormal": {"mean": 3.0, "cv": 0.3},
    "uniform": {"lower": 1.0, "upper": 4.0},
    "loguniform": {"lower": 0.5, "upper": 4.0},
    "triangular": {"lower": 1.0, "mode": 1.5, "upper": 4.0},
    "pert": {"lower": 1.0, "mode": 3.5, "upper": 4.0},
    "beta": {"alpha": 0.7, "beta": 2.5, "lower": 1.0, "upper": 4.0},
    "weibull": {"shape": 1.7, "scale": 2.0},
    "gamma": {"shape": 4.5, "scale": 0.5},
    "gumbel": {"mode": 3.0, "scale": 0.3},
    "exponential": {"mean": 1.5},
    "histogram": {"edges": [1.0, 1.5, 3.0, 4.0], "counts": [5.0, 20.0, 10.0]},
    "integer-range": {"lower": 1, "upper": 9},
}
BOUNDS = (0.2, 6.0)
CASES = [(name, {}) for name in KNOWN]
CASES += [("gamma", {"truncate": [1.0, 3.0]}), ("normal", {"truncate": [2.9, 5.0]})]
CASES += [
    ("gamma", {"shape": 0.4}),
    ("gamma", {"shape": 1e4, "scale": 2e-4}),
    ("pert", {"mode": 1.0}),
]
"""Name of a law -> arguments that differ from those above."""


@pytest.fixture(scope="module")
def asked(browser, tmp_path_factory):
    """Return a function that evaluates an expression with the scripts of a page."""
    path = tmp_path_factory.mktemp("laws") / "laws.html"
    path.write_text(f"<meta charset=utf-8><script>{scripts()}</script>", encoding="utf-8")
    browser.open(path)
    assert browser.complaints() == []
    return browser.value


def plain(name, changes):
    return ARGUMENTS[name] | {k: v for k, v in changes.items() if k != "truncate"}


def in_page(name, changes, bounds=BOUNDS):
    """Return the expression of a law."""
    law = {"distribution": name, "args": plain(name, changes), "bounds": bounds}
    return f"new Law({json.dumps(law | {'truncate': changes.get('truncate')})})"


def test_each_law_has_a_slider_or_a_reason():
    assert {*ARGUMENTS} == {*KNOWN}
    assert all(name in KNOWN or law.discrete for name, law in LAWS.items())


@pytest.mark.parametrize("moved", [(1, 0), (0.7, 0.4), (1, -1.2)], ids=str)
def test_densities_and_probabilities_are_those_of_python(asked, moved):
    for name, changes in CASES:
        x = np.linspace(0.25, 5.9, 40) if name != "integer-range" else np.arange(1.0, 7.0)
        page_values = asked(
            f"(() => {{ const law = {in_page(name, changes)}.moved({moved[0]}, {moved[1]}),"
            f" x = Float64Array.from({json.dumps(x.tolist())});"
            " const shares = [...x].map(one => law.shares(one));"
            " return {args: law.args, logs: [...law.logDensities(x)].map(String),"
            " below: shares.map(one => one[0]), above: shares.map(one => one[1])} })()"
        )
        law = law_of({"distribution": name} | changes | page_values["args"])
        logs = log_density_between(law, x, *BOUNDS)
        np.testing.assert_allclose(
            np.array(page_values["logs"], dtype=float), logs, rtol=1e-7, atol=1e-8, err_msg=name
        )
        below = cdf_within(law, x, BOUNDS)
        inside = x < 5.99 if name != "integer-range" else x < 0  # its own ends lie between numbers
        np.testing.assert_allclose(
            np.array(page_values["below"])[inside],
            below[inside],
            rtol=1e-8,
            atol=1e-12,
            err_msg=name,
        )
        np.testing.assert_allclose(
            np.array(page_values["above"])[inside],
            1 - below[inside],
            rtol=1e-6,
            atol=1e-11,
            err_msg=name,
        )
        has_room = moved[0] < 1 or not {"lower", "edges"} & {*ARGUMENTS[name]}
        assert (page_values["args"] != plain(name, changes)) == (
            moved != (1, 0) and (has_room or name == "truncated-normal")
        )


@pytest.mark.parametrize(
    "terms",
    [
        [("gamma", 1.0), ("lognormal", -2.0)],
        pytest.param([("triangular", -1.0), ("loguniform", 0.5)], marks=pytest.mark.slow),
        pytest.param(
            [("weibull", 1.0), ("beta", -1.0), ("histogram", 1.0)], marks=pytest.mark.slow
        ),
    ],
)
def test_the_law_of_a_product_is_that_of_python(asked, terms):
    laws = [law_of({"distribution": name} | ARGUMENTS[name]) for name, _ in terms]
    python = law_of_sum(
        [LogTerm(law, BOUNDS, exponent) for law, (_, exponent) in zip(laws, terms, strict=True)]
    )
    places = np.linspace(python.breaks[0], python.breaks[-1], 201)
    inside = ", ".join(f"new LogTerm({in_page(name, {})}, {e})" for name, e in terms)
    page_values = asked(
        f"(() => {{ const sum = sumOf([{inside}]);"
        f" return {json.dumps(places.tolist())}.map(t => sum.below(t)) }})()"
    )
    np.testing.assert_allclose(page_values, python.below(places), atol=1e-9)


COLUMN = """(() => {{
  const values = {0}, bytes = new Uint8Array(Float64Array.from(values).buffer);
  const encoded = btoa(String.fromCharCode(...bytes));
  const column = new Column({{label: "y", unit: "m", per: 1, wide: {1}, values: encoded}}, []);
  const ticks = new Scale(column).ticks(5);
  return [ticks.map(value => column.digits(value)), values.map(one => column.words(one))] }})()"""


@pytest.mark.parametrize(
    ("values", "wide"),
    [([1e6, 1e6 + 4e-4, 1e6 + 1e-3], False), ([1e-200, 1.0, 1e200], True), ([3.0, 3.0], False)]
    + [([1e16, 1e16 + 4], False), ([0.0, 5e-324], True), ([-1e308, 1e308], False)],
    ids=str,
)
def test_different_values_are_written_differently(asked, values, wide):
    ticks, words = asked(COLUMN.format(json.dumps(values), json.dumps(wide)))
    assert len(set(words)) == len(set(values))
    assert len(ticks) == len(set(ticks)) < 30


@pytest.mark.parametrize("half", [0.4986, 0.5, 0.94, 1.7, 9.99, 40.0])
@pytest.mark.parametrize("count", [3, 4.9, 5])
def test_an_axis_has_about_as_many_ticks_as_it_has_room_for(asked, half, count):
    column = f"{{values: [{-half}, {half}], states: [0, 0], per: 1}}"
    assert 2 <= len(asked(f"new Scale({column}).ticks({count})")) <= count + 2


@pytest.mark.parametrize(
    ("unit", "words"),
    [
        ("\u00b0", "3\u00b0"),
        ("", "3"),
        ("kN", "3 kN"),
        ("10\u00b3 m", "3\u00a0\u00d7\u00a010\u00b3 m"),
    ],
)
def test_units_stand_beside_numbers(asked, unit, words):
    plain = json.dumps({"unit": unit, "per": 1, "values": ""})
    assert asked(f"new Column({plain}, []).words(3)") == words


def test_arguments_of_laws_keep_the_digits_of_their_change(asked):
    assert asked("rounded(1e8 + 3.4567891e-4, 1e8)") == 1e8 + 3.456789e-4
    assert asked("rounded(0.8000000001, 1)") == 0.8
    page_values = asked(
        "new Law({distribution: 'uniform', bounds: [null, null], truncate: null,"
        " args: {lower: 1e6, upper: 1e6 + 1e-3}}).moved(0.5, 0).args"
    )
    assert page_values["lower"] == pytest.approx(1e6 + 2.5e-4, abs=1e-8)
    assert page_values["upper"] == pytest.approx(1e6 + 7.5e-4, abs=1e-8)


def test_a_law_that_leaves_no_row_is_refused(asked):
    weighted = "smoothed(Float64Array.of(-Infinity, NaN), null)"
    assert "no row of this result" in asked(f"{weighted}.refusal")
    assert asked("refusal(0.3, 7)") == refusal(0.3, 7)


def test_a_tail_that_begins_amid_equal_weights_has_the_same_shape(asked):
    normal = np.random.default_rng(0).standard_normal(500)
    in_steps = special.ndtr(np.round(-16 * (np.log(2) + 0.5 * normal) / 0.3) / 16)
    page_values = asked(f"tailShape(Float64Array.from({in_steps.tolist()}))")
    assert page_values == pytest.approx(tail_shape(in_steps))


@pytest.mark.parametrize("hits", [2, 15, 27, 45, 180])
@pytest.mark.parametrize("heavy", [1.0, 9.0])
def test_intervals_of_means_that_few_rows_carry(asked, hits, heavy):
    numbers, weights = np.full(200, 0.001), np.ones(200)
    numbers[:hits], weights[3:9] = 0.9, heavy
    rows = json.dumps({"count": 200, "independent": True, "students": []})
    weighed = f"new Weighed({rows}, Float64Array.from({weights.tolist()}), () => true)"
    page_values = asked(f"{weighed}.share(Float64Array.from({numbers.tolist()}))")
    expected = weighted_share(numbers, weights)
    assert [page_values[key] for key in ("share", "low", "high")] == pytest.approx(expected.numbers)
