"""The card: the answer of a study on one screen of 80 columns."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from computed import UNIFORM, asking, computed, kinds, linear, study_of, with_output, with_status
from nested_studies import nested_result, regimes

import uq as api
from benchmarks.cards import cards_on_page
from uq.assess.answer.sufficiency import needed, rounded_size, size_for
from uq.assess.answer.wording import called_together
from uq.contract import Status
from uq.render.card import SHORT, WIDTH, card, cause_columns, lines_of
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.stats.intervals import share_interval
from uq.text.numbers import grouped

STUDIES = Path(__file__).parents[3] / "studies"
QUICK = ("exponential-wear", "ishigami")


@pytest.fixture(scope="module", params=QUICK)
def shipped(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("cards") / f"{request.param}.nc"
    api.run(STUDIES / f"{request.param}.toml", path, workers=0)
    return path


def test_every_shipped_study_has_a_card_on_the_page():
    assert set(cards_on_page()) == {path.stem for path in STUDIES.glob("*.toml")}
    for text in cards_on_page().values():
        lines = text.splitlines()
        assert len(lines) <= 24 and max(map(len, lines)) <= WIDTH
    assert len(cards_on_page()["exponential-wear"].splitlines()) <= 12


def test_the_card_of_a_quick_study_is_that_of_the_page(shipped):
    assert str(card(shipped)) == cards_on_page()[shipped.stem]


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(path.stem for path in STUDIES.glob("*.toml")))
def test_the_card_of_a_shipped_study_is_that_of_the_page(name, tmp_path):
    result = api.run(STUDIES / f"{name}.toml", tmp_path / f"{name}.nc")
    assert str(card(result)) == cards_on_page()[name]


def test_every_number_of_a_card_is_traced_to_the_same_number(shipped):
    for line in card(shipped).card.headline:
        number = api.trace(shipped, line.key)["value"]
        value, low = line.estimate.value, line.estimate.low
        assert number == (low if np.isnan(value) else value), line.key


def test_terminal_json_and_python_show_one_card(uq, shipped):
    text = str(card(shipped))
    assert uq("summary", str(shipped)).out == text + "\n"
    numbers = json.loads(uq("summary", str(shipped), "--json").out)
    assert numbers["card"] == json.loads(json.dumps(card(shipped).card.json))
    for line in numbers["card"]["headline"]:
        assert set(line) == {"key", "label", "value", "low", "high", "unit"}
    for cause in numbers["card"]["causes"]:
        assert {"input", "share", "low", "high", "of", "effect", "tightened"} == set(cause)


def test_sentences_and_tables_are_asked_for(uq, shipped):
    sentences = uq("summary", str(shipped), "--explain").out
    assert "contributes most" in sentences or "contribute most" in sentences
    assert "quantile 0.5" not in sentences
    assert "quantile 0.5" in uq("summary", str(shipped), "--full").out


def life(values, **asked):
    ds = linear(samples=len(values))
    censored = np.isinf(values) & False
    ds = with_output(ds, "life", values, kind="lifetime", censored=censored)
    return asking(ds, outputs=["life"], **asked)


def hard_cases():
    rng = np.random.default_rng(3)
    yield "few rows", asking(linear(samples=4), outputs=["y"])
    yield "constant", asking(with_output(linear(), "level", np.ones(64)), outputs=["level"])
    yield "failed", asking(with_status(linear(samples=200), slice(0, 60), 4), outputs=["y"])
    yield "all failed", asking(with_status(linear(), slice(0, 64), 4), outputs=["y"])
    yield "kinds", kinds(samples=256)
    never = np.where(rng.random(400) < 0.3, np.inf, rng.lognormal(10, 2, 400))
    yield "never", life(never, tolerance={"coverage": 0.95, "confidence": 0.95})
    yield "huge", life(rng.lognormal(200, 30, 300), thresholds={"life": 1e80})
    yield (
        "tiny",
        asking(
            with_output(linear(samples=300), "level", 1e-280 * rng.random(300)),
            outputs=["level"],
            thresholds={"level": [1e-281, 5e-281, 9e-281]},
        ),
    )
    yield "replicates", linear("sobol", samples=64, replicates=8)
    yield "indices", linear("saltelli", samples=64, replicates=4)
    yield "trajectories", linear("morris", samples=32)


@pytest.mark.parametrize(("name", "ds"), [*hard_cases()], ids=lambda value: str(value)[:12])
def test_a_card_fits_on_a_screen_whatever_the_result(name, ds):
    shown = card(ds)
    lines = str(shown).splitlines()
    assert len(lines) <= 24 and max(map(len, lines)) <= WIDTH, name
    assert re.search(rf", {grouped(int(Result(ds).failed.sum()))} invalid( rows?)? ", lines[0])
    assert "failed" not in str(shown).replace("--failed", "")  # of rods, "fail within 24 h"
    assert not re.search(r"\bnan\b|\binf\b|None", str(shown)), str(shown)
    json.dumps(shown.card.json, allow_nan=False)


def test_what_counts_is_bold_and_a_warning_stands_out(shipped):
    lines = lines_of(card(shipped).card)
    main = [line for line in lines if line.bold != (0, 0)]
    assert main[0].text.startswith(shipped.stem)
    values = {line.text[slice(*line.bold)].split()[0] for line in main}
    assert values & {"4.84", "3.7"}
    warned = [line.text for line in lines if line.warns]
    assert bool(warned) == (shipped.stem == "exponential-wear")
    assert all("not a prediction" in text for text in warned[:1])


def test_a_notebook_shows_the_card(shipped):
    html = card(shipped)._repr_html_()
    assert html.startswith("<pre>") and "<b>" in html
    assert re.sub("<[^>]*>", "", html).replace("&lt;", "<").replace("&gt;", ">") == str(
        card(shipped)
    )


def test_more_rows_than_rods_come_with_the_reason():
    named = {"row_name": "pump/pumps"}
    crossed = linear("saltelli", samples=64, replicates=4, analysis={"outputs": ["y"]})
    shown = str(card(crossed.assign_attrs(named)))
    assert shown.startswith("linear   512 pumps in 1 536 rows, 0 invalid ")
    assert "no 95/95 bound: 'saltelli' rows (512 pumps and copies) are dependent" in shown
    event = linear("saltelli", samples=64, replicates=4, analysis={"thresholds": {"y": 5.0}})
    shown = str(card(event.assign_attrs(named)))
    assert "1 536 rows: 512 pumps, copies with other values of some inputs" in shown
    assert "95/95" not in shown
    repeated = nested_result(samples=300, units=1).assign_attrs(named)
    shown = str(card(repeated))
    assert re.search(r"   300 pumps, 2 runs each, 0 invalid rows ", shown)
    assert "no 95/95 bound: the 2 runs of each pump are not independent" in shown
    other = str(card(asking(linear("sobol", samples=64, replicates=8), outputs=["y"])))
    assert "512 runs, 0 invalid rows" in other
    assert "no 95/95 bound: the rows of a 'sobol' design are not independent" in other


def test_rows_are_called_what_the_model_calls_them():
    tables = {
        "study": {"name": "pumps", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 1},
        "uncertain": {"x1": {"distribution": "uniform", "lower": 0.0, "upper": 1.0}},
    }
    ds = computed(study_of(tables))
    assert str(card(ds)).splitlines()[0].startswith("pumps   1 run, 0 invalid")
    named = card(ds.assign_attrs(row_name="pump/pumps"))
    assert "1 pump, 0 invalid" in str(named)


@pytest.mark.parametrize("index", ["pawn", "delta", "KS", "hsic", "mu_star", "shapley"])
def test_an_index_is_described_in_words_and_its_range_where_it_has_one(shipped, index):
    changed = replace(card(shipped).card, index=index, share_of="")
    words, more = cause_columns(changed)[0][1]
    assert re.fullmatch("[A-Z]?[a-z]+ ?[a-z]*", words) and words != index
    assert more.startswith("0 to 1") == (index in ("pawn", "delta", "KS", "hsic"))


def test_a_short_card_says_which_interval_it_shows(shipped):
    lines = str(card(shipped)).splitlines()
    assert len(lines) <= SHORT and sum("(95 % interval)" in line for line in lines) == 2


def test_numbers_under_half_the_scatter_say_which_interval_they_have(shipped):
    shown = card(shipped)
    header, _ = cause_columns(shown.card)
    first = next(cause.tightened for cause in shown.card.causes if cause.tightened)
    assert first.after.has_interval and header[3][1].endswith("(95 % interval)")
    assert header[3][1].replace("\u00a0", " ") in str(shown)


def test_chance_comes_with_the_share_that_it_explains():
    levels = {"x1": "own", "x2": "own", "x3": "chance", "x4": "chance"}
    ds = nested_result(levels=levels, samples=300, units=1)
    (step,) = (step for step in card(ds).card.next if "expect little" in step)
    share = re.fullmatch(
        r"expect little of tolerances: chance explains (8\d\.\d) % of the variance.*", step
    )
    assert float(share[1]) == pytest.approx(100 * 25 / 30, abs=5)


def test_an_answer_whose_main_cause_is_assumed_is_no_prediction():
    ds = linear(samples=1000)
    ds["x4"].attrs["source"] = "assumed: a guess"
    study = ds.attrs["study"].replace("x4 = {", 'x4 = {source = "assumed: a guess", ')
    shown = card(asking(ds.assign_attrs(study=study), outputs=["y"])).card
    assert shown.warning == "not a prediction: x4 contributes most and is assumed"
    assert shown.warning in shown.json["checks"]
    assert any("not a prediction" in line.text and line.warns for line in lines_of(shown))


@pytest.mark.parametrize(("samples", "factor"), [(32, 1.1), (32, 2.0), (32, 5.0)])
def test_more_rows_are_of_a_size_that_the_design_allows(samples, factor):
    result = Result(linear("saltelli", samples=samples, replicates=4))
    rows = size_for(factor, result)
    wanted = rows * samples // len(result)
    assert result.design.size_problem(wanted) is None and rows >= factor * len(result)
    assert rounded_size(rows, result) == (rows, wanted)
    assert f"({wanted} samples)" in needed(factor, result)


def test_more_independent_rows_are_rounded_up():
    result = Result(linear(samples=1000))
    assert rounded_size(size_for(4.123, result), result) == (4200, 4200)


def shown_with(card, **changes):
    return [line.text for line in lines_of(replace(card, **changes))]


def named(card, *names):
    """Return the causes of a card with other inputs."""
    cause = card.causes[0]
    contribution = cause.contribution
    indices = contribution.indices[:1] * len(names)
    return cause._replace(contribution=replace(contribution, inputs=names, indices=indices))


def test_the_names_of_causes_are_whole_where_there_is_room(shipped):
    base = card(shipped).card
    first = named(base, "lateral_support_stiffness", "rotary_flexural_rigidity")
    lines = shown_with(base, causes=(first,))
    words = {word for line in lines for word in line.split()}
    assert {"lateral", "support", "stiffness", "and", "rotary", "flexural", "rigidity"} <= words
    assert not any("…" in line[:20] for line in lines)


def test_many_long_causes_leave_the_card_on_its_screen(shipped):
    base = card(shipped).card
    causes = [named(base, *(f"{a}_{'x' * 30}" for a in "abc")) for _ in range(4)]
    lines = shown_with(base, causes=tuple(causes), subject="word " * 20)
    assert len(lines) <= 24 and any("…" in line for line in lines)


def test_too_few_rows_come_with_the_number_that_suffices(shipped):
    base = card(shipped).card
    advice = ("measure the wear coefficient and the contact stiffness", "study 6 007 rods in all")
    lines = shown_with(base, next=advice, subject="word " * 20)
    assert "study 6 007 rods in all" in re.sub(r"\s+", " ", " ".join(lines[-3:]))


def test_numbers_that_are_the_same_word_are_not_joined():
    inputs = ["initial_phase_2", "synchronous_speed_2"]
    assert called_together(inputs) == "initial phase 2 and synchronous speed 2"
    assert called_together(["mole_friction", "bar_friction"]) == "mole and bar friction"


def test_a_time_of_success_has_no_words_of_failure():
    asked = {"coverage": 0.9, "confidence": 0.95}
    ds = life(np.random.default_rng(0).lognormal(1, 0.3, 400), tolerance=asked)
    shown = str(card(ds))
    assert "90/95 life" in shown and "B10" in shown
    ds["life"].attrs["success"] = "the machine has started"
    shown = str(card(ds))
    assert "90/95 bound" in shown and "10 % succeed by" in shown
    assert " life " not in shown and "B10" not in shown


def test_each_of_several_inputs_has_its_share_and_no_check_is_lost(shipped):
    base = card(shipped).card
    cause = named(base, "a", "b", "c")
    indices = (Estimate(0.28), Estimate(0.11), Estimate(0.11))
    cause = cause._replace(contribution=replace(cause.contribution, indices=indices))
    checks = (
        "too few rods: the share that fail within 24 hours is uncertain by ±2.5 percentage points",
        "89.4 % have numerical errors above 5 %",
    )
    text = re.sub(r"\s+", " ", " ".join(shown_with(base, causes=(cause,), checks=checks)))
    assert "28 + 11 + 11 %" in text and "89.4 % have numerical errors above 5 %" in text


def with_numerical_errors(relative, **analysis):
    """Return lives of a Monte Carlo sample, each with an error of this fraction of it."""
    ds = life(np.random.default_rng(5).lognormal(10, 1, 400), **analysis)
    error = ds["life"].copy(data=relative * ds["life"].values).assign_attrs(kind="value")
    return ds.assign(life_error=error)


def test_the_bound_with_numerical_errors_stands_beside_the_bound():
    asked = {"coverage": 0.95, "confidence": 0.95}
    ds = with_numerical_errors(0.3, tolerance=asked)
    shown = card(ds)
    bound, with_errors, *_ = shown.card.headline
    assert with_errors.leads and bound.label == "95/95 life"
    assert with_errors.estimate.value == pytest.approx(0.7 * bound.estimate.value, rel=1e-12)
    assert shown.card.json["headline"][1]["label"] == "95/95 life with numerical errors"
    lines = str(shown).splitlines()
    (first,) = (i for i, line in enumerate(lines) if "95/95 life" in line)
    assert re.match(
        "  with errors  +[0-9.]+ h    lives minus their numerical errors$", lines[first + 1]
    )
    exact = card(with_numerical_errors(1e-9, tolerance=asked))
    assert "numerical" not in str(exact)


def test_errors_as_large_as_the_lives_leave_no_bound():
    asked = {"coverage": 0.95, "confidence": 0.95}
    ds = with_numerical_errors(1.5, tolerance=asked)
    assert re.search(r"with errors +no life  +lives minus their numerical errors", str(card(ds)))
    assert re.search(r"error of the m\w+, up to\s+[\d.]+ \w+,\s+exceeds", str(card(ds)))


def test_laws_are_counted_without_inputs_that_equal_another_and_advice_names_these():
    laws = {"x1": {**UNIFORM}, "x3": {**UNIFORM}, "x4": {"equals": "x3"}}
    for law in (laws["x1"], laws["x3"]):
        law["source"] = "assumed"
    tables = {
        "study": {"name": "tied", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 2000, "seed": 1},
        "uncertain": laws,
        "analysis": {"outputs": ["y"], "wanted": {"y": "below"}},
    }
    shown = card(computed(study_of(tables))).card
    assert shown.assumptions == "2 of 2 laws assumed"
    assert "tighten x3 (with x4, which equals it)" in shown.next


def test_the_share_that_never_ends_is_a_range_where_censored_rows_may_not_end():
    rng = np.random.default_rng(4)
    values, censored = rng.lognormal(10, 1, 400), np.arange(400) % 10 == 1
    values[::10] = np.inf
    ds = with_output(linear(samples=400), "life", values, kind="lifetime", censored=censored)
    shown = asking(ds, outputs=["life"])
    shown["life"].attrs["never_known_at_once"] = 0
    (line,) = (line for line in card(shown).card.headline if line.label.startswith("never"))
    low, high = share_interval(values == np.inf)[0], share_interval(censored | np.isinf(values))[1]
    assert np.isnan(line.estimate.value)
    assert (line.estimate.low, line.estimate.high) == (low, high)
    words = r"never fail +\d[\d.]* to \d[\d.]* %; 10.0 % undecided: either way"
    assert re.search(words, str(card(shown)))


def test_the_most_frequent_regime_is_a_clause():
    checks = card(kinds(samples=256, analysis={"outputs": ["work"]})).card.checks
    assert any(re.fullmatch(r"\d\d\.\d % of responses are \w+", clause) for clause in checks)


def test_the_events_lead_where_a_time_of_success_has_no_bound():
    rng = np.random.default_rng(4)
    times = np.where(rng.random(400) < 0.2, np.inf, rng.lognormal(8, 1, 400))
    ds = life(times, thresholds={"life": [3600.0]})
    ds["life"].attrs["success"] = "the machine has started"
    shown = card(ds)
    assert [line.label for line in shown.card.headline if line.leads] == ["succeed within 1 hour"]
    text = str(shown)
    places = [
        text.index(part)
        for part in ("succeed within 1 h ", "no 95/95 bound: more", "50 % succeed by")
    ]
    assert places == sorted(places)


def test_causes_and_advice_on_regimes_are_about_one_event_where_chance_decides():
    ds = nested_result(levels={"x1": "own", "x2": "chance"}, samples=600, units=1, repeats=2)
    wild = 0.3 * ds["x1"].values + ds["x2"].values > 0.5
    shown = card(asking(regimes(ds, wild), outputs=["regime", "y"]))
    assert shown.card.share_of == "P(wild)"
    (chance, share), (machine, _) = shown.card.levels
    assert (chance, machine) == ("chance, in all", "the machine, in all") and share.value > 0.5
    assert re.search(rf"{chance} +{100 * share.value:.0f} % \(", str(shown))
    assert "expect little of tolerances: chance matters more than the machine" in shown.card.next
    calm = card(asking(regimes(ds, ds["x1"].values > 0.3), outputs=["regime", "y"])).card
    assert calm.levels == ()


def test_intervals_of_a_card_allow_for_invalid_rows():
    ds = life(np.random.default_rng(5).lognormal(10, 1, 400), thresholds={"life": [3e4]})
    without = ds.copy(deep=True)
    without["life"][:40] = np.nan
    failed = card(with_status(without, slice(0, 40), Status.RAISED)).card
    whole = {line.label: line.estimate for line in card(ds).card.headline}
    assert {"median", "B10"} <= {line.label for line in failed.headline}
    for line in failed.headline:
        if line.label in whole and line.estimate.has_interval and not line.is_range:
            width = line.estimate.high - line.estimate.low
            assert width > 1.3 * (whole[line.label].high - whole[line.label].low), line.label


def test_a_smaller_scatter_that_makes_matters_worse_is_marked():
    ds = linear(samples=2000, analysis={"outputs": ["y"], "wanted": {"y": "below"}})
    base = card(ds).card
    first = base.causes[0]
    assert first.tightened is not None and first.tightened.helps
    worse = replace(first.tightened, wants_more=True)
    shown = shown_with(base, causes=(first._replace(tightened=worse),))
    assert any(line.endswith(", worse") for line in shown)


def test_a_quantile_in_place_of_a_bound_comes_with_its_numerical_errors():
    ds = linear("saltelli", samples=64, replicates=8)
    ds = asking(ds, outputs=["y"], wanted={"y": "above"})
    ds = with_output(ds, "y_error", np.full(ds.sizes["row"], 0.2))
    quantile, with_errors = card(ds).card.headline[:2]
    assert with_errors.label == "5 % quantile with numerical errors"
    assert with_errors.estimate.value == pytest.approx(quantile.estimate.value - 0.2, rel=1e-9)


def test_too_few_rows_are_too_few_for_a_result_even_if_the_causes_state_the_reason():
    shown = card(asking(linear(samples=100), outputs=["y"])).card
    assert shown.no_causes.startswith("the ranking of the inputs is not settled: ")
    assert "too few runs: the ranking of the inputs is not settled" in shown.checks


def test_more_accurate_rows_are_advised_with_the_setting_that_makes_them():
    ds = with_numerical_errors(0.3)
    ds["life"].attrs |= {"accuracy": 0.05, "accuracy_setting": "accuracy"}
    shown = card(ds).card
    (step,) = (step for step in shown.next if "not more runs" in step)
    value = re.fullmatch(r"set accuracy = (0\.0\d+), not more runs", step)
    assert float(value[1]) <= 0.025
    assert not any("too few" in check for check in shown.checks)
    del ds["life"].attrs["accuracy_setting"]
    assert "use finer settings, not more runs" in card(ds).card.next


def test_a_missing_column_of_half_the_scatter_has_a_reason():
    regimes = card(kinds(samples=256, analysis={"outputs": ["regime", "work"]})).card
    if regimes.causes:
        assert regimes.not_halved == "not estimated for regimes"
    law = {"distribution": "discrete-choice", "values": [1e-9, 2e-9, 3e-9]}
    tables = {
        "study": {"name": "pads", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 400},
        "uncertain": {"rate": law},
    }
    shown = card(computed(study_of(tables)))
    assert shown.card.causes and shown.card.causes[0].tightened is None
    assert "half scatter: none, the law of rate has no width to halve" in str(shown)


def test_half_the_scatter_is_shown_even_if_no_tolerance_is_advised():
    """Halving a cause that hardly moves the quantile is a result, too."""
    ds = linear("saltelli", samples=32, replicates=4)
    shown = card(asking(ds, outputs=["y"], wanted={"y": "below"})).card
    assert shown.causes and not any("tighten" in step for step in shown.next)
    assert all(cause.tightened.statistic == "the 95 % quantile" for cause in shown.causes)


def test_a_law_of_few_values_and_a_fixed_value_without_source_are_pointed_out():
    values = [1e-9 * (1 + 0.1 * i) for i in range(12)]
    tables = {
        "study": {"name": "pads", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 100},
        "fixed": {"depth": 2e-3},
        "uncertain": {"rate": {"distribution": "empirical", "values": values}},
    }
    clause = "the law of rate rests on 12 values; depth fixed without a source"
    shown = card(computed(study_of(tables)))
    assert f"! {clause}" in str(shown) and clause in shown.card.json["checks"]
    tables["uncertain"]["rate"]["values"] = [1e-9 * (1 + 0.01 * i) for i in range(100)]
    tables["fixed"]["depth"] = {"value": 2e-3, "source": "drawing 7: given"}
    result = computed(study_of(tables))
    assert card(result).card.sources == ""
    assert result["depth"].attrs["source"] == "drawing 7: given"
    tables["fixed"]["depth"] = "250 um"  # nominal: it has the source of that
    assert card(computed(study_of(tables))).card.sources == ""
    del tables["fixed"]
    assert card(computed(study_of(tables))).card.sources == ""
