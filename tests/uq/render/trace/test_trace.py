"""Every number has a key, which leads to its estimator, its rows, and the same number again."""

import html
import json
import re
import time
from pathlib import Path

import answered
import numpy as np
import pytest
from command_line import strict_json
from computed import asking, computed, kinds, linear, with_output
from learnt_studies import measured, wear
from nested_studies import nested

import uq as api
from uq.assess.answer.answer import answer
from uq.errors import InputError
from uq.explore.single_rows import row
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.learning.posterior_result import as_unit
from uq.render.html.page import page
from uq.render.trace.trace import trace_json, traced
from uq.render.trace.verbs import VERBS
from uq.result.result import Result
from uq.text.keys import key_of, paths_of_numbers, taken_apart, value_at

MEDIAN = "outputs/life/quantiles/0.5"
FAILING = {"fail_above": 0.9, "fail_how": "raise"}
ASKED = {
    "outputs": ["life", "angle"],
    "quantiles": [0.05, 0.5, 0.999],
    "thresholds": {"life": [0.9, 1.2], "angle": 0.5},
    "tolerance": {"coverage": 0.8, "confidence": 0.8},
}
COUNTS = (
    *("counts", "status_counts", "independent_rows", "b_lives", "nesting_of", "switching"),
    *("earliest_rows", "lowest_rows"),
)
COMPARED = (*COUNTS, "enough")
"""Functions that estimate nothing, or compare estimates: they cite nobody."""


def crossed():
    return linear("saltelli", 16, 4, settings=FAILING, analysis={"thresholds": {"y": 5.0}})


def every_kind():
    return kinds(samples=64, analysis=ASKED)


def slow(*case):
    return pytest.param(*case, marks=pytest.mark.slow)


def check(ds, verb, options=None, every=1):
    """Trace the numbers of a verb, all of them or one of so many."""
    options = options or {}
    whole = VERBS[verb].facts(Result(ds), options, ()).json
    paths = list(paths_of_numbers(whole))[::every]
    assert paths
    for path in paths:
        key = key_of(*path, verb=verb, options=options)
        traced_number = traced(Result(ds), key)
        entry = value_at(whole, path)
        wanted = entry if isinstance(entry, dict) else {"value": entry}
        assert traced_number.equal and traced_number.key == key
        assert traced_number.numbers.items() <= wanted.items()
        assert all(estimator.does for estimator in traced_number.estimators)
        if entry is not None and not all(
            estimator.code.endswith(COMPARED) for estimator in traced_number.estimators
        ):
            assert any(estimator.sources for estimator in traced_number.estimators), key


@pytest.mark.parametrize(
    ("make", "verb"),
    [
        (crossed, "summary"),
        (crossed, "sensitivity"),
        (lambda: computed(nested()), "summary"),
        (lambda: computed(nested()), "sensitivity"),
        (lambda: computed(nested()), "levels"),
    ],
)
def test_numbers_are_traced_and_equal(make, verb):
    check(make(), verb, every=3 if verb == "summary" else 1)


@pytest.mark.parametrize(
    ("verb", "every"), [("summary", 31), ("sensitivity", 31), ("levels", 31), ("convergence", 300)]
)
def test_numbers_of_lives_and_angles_are_traced_and_equal(verb, every):
    check(every_kind(), verb, every=every)


@pytest.mark.slow
@pytest.mark.parametrize("verb", ["summary", "answer", "sensitivity", "levels", "convergence"])
def test_every_number_of_every_kind_is_traced_and_equal(verb):
    check(every_kind(), verb)
    check(crossed(), verb)


@pytest.mark.slow
def test_options_are_part_of_a_key():
    ds = every_kind()
    check(ds, "summary", {"regime": "fast"}, every=17)
    check(ds, "sensitivity", {"method": "pawn"}, every=31)
    check(ds, "fleet", {"size": "1", "by": "0.7", "output": "life[side=left,depth=0.5]"}, every=3)
    check(linear(), "what-if", {"uncertain.x1.upper": "0.9"})
    check(crossed(), "inputs", every=5)
    check(update(wear(400), measured(5e5)), "update", {"by": "600000.0"}, every=11)


@pytest.mark.parametrize(
    ("make", "path", "estimator"),
    [
        slow(every_kind, "outputs/angle/thresholds/0.5/above", "WeightedMixture.probability_above"),
        slow(every_kind, "outputs/angle/quantiles/0.5", "WeightedMixture.quantile"),
        (every_kind, "outputs/angle/effective_rows", "importance_weights.effective_rows"),
        slow(every_kind, "regime/slow", "means.weighted_share"),
        (linear, "outputs/y/mean", "means.weighted_moments"),
    ],
)
def test_weighted_rows_are_traced_to_estimators_of_weighted_rows(make, path, estimator):
    ds, key = make(), "what-if[uncertain.x1.upper=0.8]/"
    what_if, *others = traced(Result(ds), key + path).estimators
    assert what_if.code.endswith("what_if") and others[0].code.endswith(estimator)
    plain = (
        [step.code for step in traced(Result(ds), path).estimators]
        if "effective" not in path
        else []
    )
    assert not {function.code for function in others} & {*plain}


def test_the_quality_of_weights_is_traced_to_its_estimators():
    ds = Result(update(wear(150), measured(5e5)))
    for key in ("levels/", "update/", "fleet[size=1]/", ""):
        for name, function in (("effective_rows", "effective_rows"), ("pareto_k", "tail_shape")):
            estimators = traced(ds, f"{key}{name}").estimators
            assert estimators[-1].code == f"uq.stats.importance_weights.{function}"


def test_numbers_of_a_design_without_statistics_are_traced():
    check(linear("morris", 8), "summary")
    traced_number = traced(Result(linear("morris", 8)), "outputs/y/mean")
    assert (
        traced_number.numbers == {"value": None}
        and traced_number.rows_used == traced_number.rows == 40
    )
    assert traced_number.notes == (
        "no statistics: the rows of a 'morris' design do not follow the laws of"
        " the inputs; see 'uq sensitivity'",
    )


def test_the_error_of_the_rows_is_that_of_the_rows_used():
    ds = crossed()
    ds = with_output(ds, "y_error", np.where(ds["block"] == 1, 1e6, ds["x1"]))
    traced_number = traced(Result(ds), "convergence/outputs/y/own_error")
    used = ds["x1"].values[np.isin(ds["block"], [0, 5])]
    assert traced_number.equal and traced_number.numbers["value"] == pytest.approx(used.mean())
    for key in ("answer/enough/own_error", "answer/enough/sampling_error"):
        answered = traced(Result(with_output(ds, "y_error", 10 * ds["x1"].values)), key)
        assert answered.equal and answered.rows_used == len(used)


def test_a_ranking_of_samples_with_several_rows_says_which_it_rests_on():
    ds = computed(nested(samples=200))
    quantities = answer(ds).fact.json["quantities"]
    name, first = next(
        (name, quantity["ranking"]["contributions"][0]["inputs"])
        for name, quantity in quantities.items()
        if quantity["ranking"]["contributions"]
    )
    key = key_of("quantities", name, *_CONTRIBUTION, next(iter(first)), verb="answer")
    (note,) = api.trace(ds, key)["notes"]
    assert note == f"the index uses {ds.attrs['samples']} of these rows, the first of each sample"


_CONTRIBUTION = ("ranking", "contributions", "0", "inputs")


def test_values_of_options_may_have_commas():
    law = '{distribution = "uniform", lower = 0.1, upper = 0.9}'
    assert traced(Result(linear()), f"what-if[uncertain.x1={law}]/outputs/y/mean").equal
    of = {name: verb.options for name, verb in VERBS.items()}
    for verb, options in (
        ("what-if", {"dependence.rank_correlation": "[[1, 0.5], [0.5, 1]]", "uncertain.x.sd": "1"}),
        ("fleet", {"size": "2", "output": "life[side=left,depth=0.5]"}),
        ("summary", {"regime": "fast,[wild]"}),
    ):
        assert taken_apart(key_of("a", verb=verb, options=options), of) == (verb, options, ("a",))


def test_an_error_of_sampling_is_traced_where_there_are_no_running_estimates():
    ds = linear("fast", 65, 2)
    traced_number = traced(Result(ds), "convergence/outputs/y/sampling_error")
    assert (
        traced_number.equal
        and traced_number.numbers["value"] == api.enough(ds).loc["y", "sampling"]
    )


@pytest.mark.parametrize("every", [60, pytest.param(9, marks=pytest.mark.slow)])
def test_numbers_of_an_inspected_unit_are_traced_and_equal(every):
    after = update(wear(150, units=2, rate="shared"), measured(5e5, 8e5))
    check(as_unit(after, "B"), "summary", every=every)
    assert (
        traced(Result(as_unit(after, "A")), MEDIAN).numbers != traced(Result(after), MEDIAN).numbers
    )


def keys_in(text):
    """Return the keys that a page shows; a sentence may have several."""
    keys = re.findall(r'data-trace="(.*?)"', text, re.DOTALL)
    return [key for several in keys for key in html.unescape(several).split("\n")]


@pytest.mark.slow
def test_the_numbers_of_each_sentence_lead_to_themselves():
    ds = kinds(samples=400, analysis=ASKED)
    conclusions = api.answer(ds)
    text = conclusions._repr_html_()
    keys = keys_in(text)
    assert {
        f"answer/quantities/{conclusions.lead.name}/{part}" for part in ("promise", "range")
    } < {*keys}
    assert any("/share" in key for key in keys) and any("/contributions/" in key for key in keys)
    for key in keys:
        assert traced(Result(ds), key).equal, key
    rest = re.sub(r"<span data-trace=.*?</span>|<style>.*?</style>", "", text, flags=re.DOTALL)
    assert "\N{NO-BREAK SPACE}%" in text and "\N{NO-BREAK SPACE}%" not in rest


def test_every_number_of_a_report_leads_to_itself(no_other_figures):
    ds = crossed()
    text = page(Result(ds), "out.nc")
    card, _, sentences_and_tables = text.partition('<details class="in-sentences">')
    keys = keys_in(sentences_and_tables)
    assert len(keys) == len(set(keys)) > 15
    of_card = keys_in(card)
    assert len(of_card) == len(set(of_card)) > 3  # which repeats numbers that stand below
    for key in {*keys, *of_card}:
        assert traced(Result(ds), key).equal, key
    assert "outputs/y/thresholds/5.0/above" in keys
    assert "sensitivity[method=sobol]/outputs/y/S1/x1" in keys
    assert {"status/ok", "outputs/y/mean", "outputs/y/failed"} <= set(keys)
    assert {"answer/rows", "answer/failed", "inputs/x1/sampled/0.05"} <= set(keys)


def test_the_rows_are_those_that_the_number_rests_on():
    ds = crossed()
    traced_number = traced(Result(ds), "outputs/y/quantiles/0.5")
    independent = np.isin(ds["block"].values, [0, 5])
    assert (
        (traced_number.rows_used, traced_number.rows)
        == (independent.sum(), len(independent))
        == (128, 384)
    )
    assert traced_number.which == "blocks A, B: 0 to 378 by 6, 5 to 383 by 6"
    numbers = [n for run in traced_number.runs for n in range(run.first, run.last + 1, run.step)]
    assert sorted(numbers) == np.flatnonzero(independent).tolist()
    lost = int(ds["status"].values[independent].astype(bool).sum())
    assert traced_number.states == {"with a value": 128 - lost, "failed": lost}
    whole = (ds["status"].values.reshape(-1, 6) == 0).all(axis=1).sum()
    states = traced(Result(ds), "sensitivity/outputs/y/S1/x1").states
    assert states["in groups with a value in each row"] == 6 * whole
    last = traced(Result(ds), "convergence/outputs/y/estimates/mean/0/value")
    assert last.rows_used == 128 and last.equal


def test_a_trace_says_who_estimates_and_who_made_the_rows(uq, write_study):
    uq("run", write_study("exponential-wear", uncertain=("rate",), law=LAW), "-o", "out.nc")
    summary = strict_json(uq("summary", "out.nc", "--json").out)
    entry = summary["outputs"]["life"]["quantiles"]["0.5"]
    document = strict_json(uq("trace", "out.nc", "outputs/life/quantiles/0.5", "--json").out)
    ds = api.open_result("out.nc")
    assert entry.items() <= document.items() and document["equal"] is True
    assert document["again"] == entry
    assert "Hyndman" in document["estimators"][0]["sources"][0]
    assert document["rows"]["used"] == 64
    assert (document["seed"], document["code"]) == (5, ds.attrs["code"])
    assert document["versions"]["numpy"] == np.__version__ and document["versions_here"] == {}
    shown = uq("trace", "out.nc", "outputs/life/quantiles/0.5").out
    assert repr(entry["value"]) in shown and "Computed again from these rows: equal" in shown
    assert max(map(len, shown.splitlines())) <= 80
    series = api.trace("out.nc", "outputs/life/quantiles/0.5/low")
    assert series["value"] == entry["low"] and series["equal"] is True


@pytest.mark.parametrize(
    ("key", "words", "number"),
    [
        (
            "outputs/life/quantiles/0.5",
            "50 % quantile of life, time until",
            r"low +\S+ s +\S+ days",
        ),
        ("outputs/life/quantiles/0.5/low", "50 % quantile low of life", r"value +\S+ s +\S+ days"),
        ("outputs/life/mean", "mean of life", r"value +\S+ s +\S+ days"),
        ("outputs/life/thresholds/5 days/below", "P(< 5 days) of life", r"value +\S+ +\S+ %"),
        ("answer/quantities/life/promise", "tolerance bound of life", r"confidence +\S+ *\n"),
        ("answer/quantities/life/range/never", "range never of life", r"value +\S+ *\n"),
        ("inputs/rate/stated", "inputs/rate/stated", r"0.5 +\S+ m s⁻¹ +\S+ pm s⁻¹"),
        ("samples", "samples", r"value +64 *\n"),
        ("levels/outputs/log(life)/own", "own of log(life)", r"value +\S+ +\S+ %"),
    ],
)
def test_a_trace_shows_words_and_units(uq, write_study, key, words, number):
    asked = '[analysis]\nthresholds = {life = "5 days"}'
    path = write_study("exponential-wear", uncertain=("rate",), law=LAW, more=asked)
    uq("run", path, "-o", "out.nc")
    shown = uq("trace", "out.nc", key).out.partition("estimator")[0]
    assert words in shown and re.search(rf"^ +{number}", shown, re.MULTILINE), shown


LAW = 'distribution = "uniform", lower = 1e-10, upper = 9e-10'


@pytest.mark.slow
def test_numbers_of_weighted_rows_are_traced_too():
    ds = update(wear(samples=2000, analysis={"thresholds": {"life": [5.2e5]}}), measured(5e5))
    check(ds, "summary", every=4)
    check(ds, "answer", every=11)
    assert traced(Result(ds), "effective_rows").estimators[0].code.endswith("effective_rows")
    with pytest.raises(InputError, match="not with rows that inspections have weighted"):
        traced(Result(ds), "sensitivity/rows_used")


@pytest.mark.parametrize("size", [5e-324, 1e300])
def test_numbers_at_the_ends_of_the_range_are_traced(size, no_other_figures):
    ds = with_output(linear(), "v", np.random.default_rng(0).uniform(-1, 1, 64) * size)
    check(ds, "summary", every=7)
    check(ds, "answer", every=13)
    assert "outputs/v/quantiles/0.5" in page(Result(ds), "out.nc")
    assert row(ds, lowest="v")["v"].item() == ds["v"].min().item()


@pytest.mark.slow
def test_neither_the_model_nor_its_code_is_needed(uq, write_study, no_other_figures):
    kind = "sample_models:KINDS"
    uq("run", write_study(uncertain=("x1",)), "-o", "out.nc", "--model", kind, "--quiet")
    ds = api.open_result("out.nc").assign_attrs(model="gone", code="0", numpy="0.9")
    for key in ("outputs/angle/mean", "answer/quantities/angle/range", "status/ok"):
        document = trace_json(traced(Result(ds), key))
        assert (
            document["equal"] and document["code"] == "0" and "numpy" in document["versions_here"]
        )
    write_result(ds, Path("gone.nc"))
    assert uq("report", "gone.nc", "--dossier").code == uq("report", "gone.nc").code == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    "key",
    [
        "outputs/life/quantiles/0.05",
        "sensitivity/outputs/y/S1/x1",
        "convergence/outputs/y/estimates/mean/0",
        "what-if[uncertain.x1.upper=0.9]/outputs/y/mean",
        "answer/quantities/y/promise",
        "answer/quantities/y/ranking/contributions/0/inputs/x4",
        "outputs/mistyped",
    ],
)
def test_a_number_of_a_large_result_is_traced_in_seconds(key):
    ds = linear(samples=100_000)
    for name in "abcdefghij":
        ds = with_output(ds, name, ds["y"].values + ord(name))
    life = np.where(ds["x1"] < 0.02, np.inf, np.exp(ds["y"].values))
    ds = with_output(ds, "life", life, "lifetime", np.zeros(100_000, bool))
    start = time.process_time()
    if key.endswith("mistyped"):
        with pytest.raises(InputError, match="no such key"):
            traced(Result(ds), key)
    else:
        assert traced(Result(ds), key).equal
    assert time.process_time() - start < 10.0


def test_names_with_a_slash_have_keys_of_their_own():
    ds = with_output(linear(), "a/b", linear()["y"].values)
    ds = with_output(ds, "a", linear()["x1"].values)
    traced_number = traced(Result(ds), "outputs/a~1b/mean")
    assert traced_number.equal and traced_number.numbers["value"] == linear()["y"].values.mean()
    with pytest.raises(InputError, match="no such key 'outputs/a/b/mean'; did you mean"):
        traced(Result(ds), "outputs/a/b/mean")


def test_a_key_as_long_as_a_book_is_refused_in_a_line():
    for key in ("outputs/" + "a" * 9999, "sensitivity[a=" + "b" * 9999 + "]/x", "outputs/\ny/\n"):
        with pytest.raises(InputError) as refusal:
            traced(Result(linear()), key)
        assert len(str(refusal.value)) < 600 and "\n" not in str(refusal.value)
    assert traced(Result(linear()), "  outputs/y/mean\n").equal  # as copied


@pytest.mark.parametrize(
    ("key", "words"),
    [
        ("outputs/y/quantile/0.5", "did you mean 'outputs/y/quantiles/0.5'?"),
        ("output/y/mean", "did you mean 'outputs/y/mean'?"),
        ("outputs/z/mean", "did you mean 'outputs/y/mean'?"),
        ("outputs/y/units", "no such key 'outputs/y/units'"),
        ("outputs/y", "several numbers; add to it, as in 'outputs/y/mean'"),
        ("sensitivity/outputs/y/S1/x9", "did you mean 'sensitivity/outputs/y/S1/x"),
        ("sensitivty/outputs/y/S1/x1", "did you mean 'sensitivity'?"),
        ("sensitivity[mehod=sobol]/rows_used", "no such option of sensitivity: mehod=sobol"),
        ("sensitivity[method=sobl]/rows_used", "no such method 'sobl'; did you mean 'sobol'?"),
        ("summary[regime=slow]/samples", "this result has no regimes"),
        ("twin/outputs/y/mean", "the study names no twin"),
        ("", "no such key ''"),
    ],
)
def test_a_mistyped_key_is_one_line_with_the_nearest(key, words):
    with pytest.raises(InputError) as refusal:
        traced(Result(crossed()), key)
    assert words in str(refusal.value) and "\n" not in str(refusal.value)


def test_a_result_without_a_sound_row_is_traced_too():
    ds = linear(settings={"fail_above": 0.0, "fail_how": "raise"})
    document = trace_json(traced(Result(ds), "outputs/y/mean"))
    assert document["value"] is None and document["equal"]
    assert document["rows"]["states"] == {"with a value": 0, "failed": 64}
    assert traced(Result(ds), "status/raised").numbers == {"value": 64}
    json.dumps(document, allow_nan=False)


def test_numbers_of_the_answer_are_those_of_its_sentences_and_have_keys(uq, write_study):
    ds = every_kind()
    check(ds, "answer", every=101)
    check(crossed(), "answer", every=17)
    key = "answer/quantities/life[side=left,depth=0.5]/promise"
    numbers, quantities = traced(Result(ds), key).numbers, api.answer(ds).quantities
    tolerance_bound = next(
        quantity for quantity in quantities if quantity.name == "life[side=left,depth=0.5]"
    ).tolerance_bound
    assert (numbers["lower"], numbers["sentence"]) == (
        tolerance_bound.lower,
        tolerance_bound.sentence,
    )
    uq("run", write_study("exponential-wear", uncertain=("rate",), law=LAW), "-o", "out.nc")
    whole = strict_json(uq("summary", "out.nc", "--json").out)
    entry = whole["answer"]["quantities"]["life"]["range"]
    again = strict_json(uq("trace", "out.nc", "answer/quantities/life/range", "--json").out)
    assert entry.items() <= again.items() and again["equal"]
    quantile = whole["outputs"]["life"]["quantiles"]["0.5"]["value"]
    assert entry["median"] == quantile == again["median"]


def test_a_threshold_may_be_given_with_its_unit():
    ds = answered.lifetime()[0]
    ds = asking(ds, outputs=["life"], thresholds={"life": "24 hours"})
    with_unit = traced(Result(ds), "outputs/life/thresholds/24 hours/below").numbers
    assert with_unit == traced(Result(ds), "outputs/life/thresholds/86400.0/below").numbers
