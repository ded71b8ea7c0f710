"""Every sentence of the answer against the numbers under it, on studies of different kinds."""

import re
from dataclasses import replace

import numpy as np
import pytest
from computed import (
    as_text,
    asking,
    computed,
    kinds,
    linear,
    study_of,
    summarised,
    with_output,
    with_status,
)

import uq
from uq.analysis import findings
from uq.conclusions.answer import answer
from uq.conclusions.contributions import Change, Ranking
from uq.conclusions.parts import Event
from uq.conclusions.promises import Promise
from uq.conclusions.remedies import Tightened
from uq.conclusions.tightening import halved
from uq.conclusions.words import Unit, called_together, rounded
from uq.contract import Status
from uq.estimate import Estimate
from uq.printed import printed
from uq.study.reading import read_study_text
from uq.wording import rows_in_words

DAY = 86400.0
NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"


def numbers(pattern, text):
    found = re.fullmatch(pattern.replace("#", NUMBER), text)
    assert found, text
    return [float(one) for one in found.groups()]


@pytest.fixture(scope="module")
def lifetime():
    """A life with a known law, of independent rows: rate contributes 25/26 of the log variance."""
    lognormal = {"distribution": "lognormal"}
    tables = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 1000, "seed": 1},
        "uncertain": {
            "rate": lognormal | {"median": 2.5e-10, "sigma": 0.5, "source": "assumed: a guess"},
            "depth": lognormal | {"median": 2.5e-4, "sigma": 0.1, "source": "measured"},
        },
        "analysis": {"thresholds": {"life": 10 * DAY}},
    }
    ds = computed(study_of(tables))
    return ds, answer(ds)


def test_the_promise_of_a_life_is_its_lower_tolerance_bound_rounded_down(lifetime):
    ds, found = lifetime
    assert found.lead.promise.why == ""
    (days,) = numbers(
        "With 95 % confidence, at least 95 % last longer than # days.", found.lead.promise.sentence
    )
    asked = {"coverage": 0.95, "confidence": 0.95}
    bound = summarised(asking(ds, tolerance=asked))["outputs"]["life"]["tolerance"]["lower"]
    assert found.lead.promise.lower == bound
    assert bound * 0.99 < days * DAY <= bound


def test_the_likely_range_is_that_of_the_quantiles(lifetime):
    ds, found = lifetime
    low, high, median = numbers(
        r"90 % lie between # and # days; median # days\.", found.lead.range.sentence
    )
    known = summarised(ds)["outputs"]["life"]["quantiles"]
    shown = {"0.05": low, "0.95": high, "0.5": median}
    for p, value in shown.items():
        assert value * DAY == pytest.approx(known[p]["value"], rel=5e-3)


def test_a_threshold_has_its_probability_and_what_decides_it(lifetime):
    ds, found = lifetime
    (event,) = found.lead.events
    *shown, at = numbers(r"# % \(# to # %\) end within # days\.", event.sentence)
    known = summarised(ds)["outputs"]["life"]["thresholds"][repr(10 * DAY)]["below"]
    assert at == 10
    ends = [100 * known[key] for key in ("value", "low", "high")]
    assert shown == pytest.approx(ends, abs=0.05)
    least, below, most, above = numbers(
        r"Decided most by rate: from # % where it is below # pm s⁻¹"
        r" to # % where it is above # pm s⁻¹\.",
        event.decided_by,
    )
    rate, life = ds["rate"].values, ds["life"].values
    low, high = event.curve.around(0)[1], event.curve.around(len(event.curve.shares) - 1)[0]
    assert low >= event.curve.edges[1] and high < event.curve.edges[-2]  # parts alike are one
    assert (below, above) == pytest.approx((low * 1e12, high * 1e12), rel=5e-3)
    assert least == pytest.approx(100 * (life[rate < low] < 10 * DAY).mean(), abs=0.06)
    assert most == pytest.approx(100 * (life[rate >= high] < 10 * DAY).mean(), abs=0.06)


def test_a_contribution_has_size_and_direction(lifetime):
    _, found = lifetime
    first = found.lead.ranking.contributions[0]
    assert first.inputs == ("rate",) and first.indices[0].low < 25 / 26 < first.indices[0].high
    by, low, high = numbers(
        r"10 % more shortens it by # % \(# to #\)", first.effect
    )  # exactly, as the life is depth over rate
    assert (by, low, high) == pytest.approx([100 - 100 / 1.1] * 3, abs=0.01)
    assert found.lead.ranking.sentence.startswith("Rate contributes most: 9")


def test_an_assumed_law_that_matters_is_measured_first(lifetime):
    ds, found = lifetime
    assert [one.rule for one in found.advice] == ["measure", "tighten"]
    assert found.advice[0].text == (
        "Measure rate first: it matters most to how many end within 10 days, and its law is"
        " assumed."
    )
    known = ds.copy()
    known["rate"].attrs["source"] = "measured"
    assert [one.rule for one in answer(known).advice] == ["tighten", "nothing"]


def test_half_the_scatter_is_what_the_weighted_rows_say(lifetime):
    ds, found = lifetime
    one = next(one.tightened for one in found.advice if one.rule == "tighten")
    _, now, then, low, high = numbers(
        r"Half the scatter of rate would move the share of rows that end within # days"
        r" from # % to # % \(# to # %\)\.",
        one.sentence,
    )
    column = f"P(<{10 * DAY!r})"
    weighted = uq.what_if(ds, {"uncertain.rate.sigma": 0.25}).loc["life"]
    known = [100 * weighted[f"{column}{end}"] for end in ("", "_low", "_high")]
    assert [then, low, high] == pytest.approx(known, abs=0.05)
    assert now == pytest.approx(100 * uq.summary(ds).loc["life", column], abs=0.05)
    assert one.effective_rows < 1000


def test_half_the_scatter_of_a_law():
    laws = {
        "uniform": ({"lower": 1.0, "upper": 3.0}, {"lower": 1.5, "upper": 2.5}),
        "loguniform": ({"lower": 1.0, "upper": 16.0}, {"lower": 2.0, "upper": 8.0}),
        "triangular": (
            {"lower": 0.0, "mode": 1.0, "upper": 4.0},
            {"lower": 0.5, "upper": 2.5},
        ),
        "lognormal": ({"mean": 2.0, "cv": 0.2}, {"cv": 0.1}),
        "weibull": ({"shape": 2.0, "scale": 1.0}, {}),
    }
    for name, (arguments, expected) in laws.items():
        uncertain = {"x1": {"distribution": name, **arguments}}
        tables = {
            "study": {"name": "laws", "model": "ishigami"},
            "design": {"method": "monte-carlo", "samples": 8},
            "uncertain": uncertain,
        }
        law = read_study_text(as_text(tables), "study").uncertain["x1"]
        assert halved(law) == pytest.approx(expected)


def test_an_angle_is_promised_by_its_magnitude_in_degrees():
    turn = np.random.default_rng(1).uniform(-0.5, 0.5, 200)
    ds = with_output(linear(samples=200), "turn", turn, "angle")
    ds["turn"].attrs["units"] = "rad"
    found = answer(asking(ds, outputs=["turn"], thresholds={"turn": 0.4})).lead
    (bound,) = numbers(
        "With 95 % confidence, at least 95 % stay within #°.", found.promise.sentence
    )
    assert np.degrees(found.promise.upper) == pytest.approx(bound, rel=5e-3) and bound > 27
    share, _, _, at = numbers(
        r"# % \(# to # %\) exceed # rad in magnitude\.", found.events[0].sentence
    )
    assert share == pytest.approx(100 * (abs(turn) > 0.4).mean(), abs=0.05)
    assert at == 0.4  # as the study has it


def test_rows_that_are_not_independent_give_a_cautious_quantile_and_the_reason():
    ds = linear("saltelli", samples=64, replicates=4)
    found = answer(ds).lead
    low, cautious, high, bold = numbers(
        "95 % stay above #, cautiously #; 95 % stay below #, cautiously #.", found.promise.sentence
    )
    known = summarised(ds)["outputs"]["y"]["quantiles"]
    shown = [known["0.05"]["value"], known["0.05"]["low"]]
    shown += [known["0.95"]["value"], known["0.95"]["high"]]
    assert [low, cautious, high, bold] == pytest.approx(shown, rel=1e-2)
    assert cautious <= shown[1] and bold >= shown[3]
    assert found.promise.why.startswith(
        "No tolerance bound: the rows of a 'saltelli' design are not independent."
    )
    first = found.ranking.contributions[0]
    assert first.inputs == ("x4",) and first.indices[0].low < 16 / 30 < first.indices[0].high
    by, *_ = numbers(r"one standard deviation more raises it by # \(# to #\)", first.effect)
    assert by == pytest.approx(4 / 12**0.5, rel=0.02)


def test_regimes_are_named_with_their_shares():
    ds = kinds(samples=200)
    found = answer(ds)
    shares = summarised(ds)["regime"]
    assert len(found.regimes) == 2
    for one in found.regimes:
        share, low, high = numbers(rf"# % \(# to # %\) {one.said}\.", one.sentence)
        known = [100 * shares[one.said][key] for key in ("share", "low", "high")]
        assert [share, low, high] == pytest.approx(known, abs=0.05)
    assert all(one.said in found.regimes_sentence for one in found.regimes)


@pytest.mark.parametrize("rows", [1, 5])
def test_few_rows_promise_nothing(rows):
    found = answer(linear(samples=rows))
    assert "confidence" not in repr(found)
    assert found.lead.promise.sentence == ""
    assert re.fullmatch(r"No tolerance bound: it needs \d+ rows\.", found.lead.promise.why)
    assert found.lead.ranking.leader is None


def test_where_every_row_failed_only_that_is_said():
    ds = linear(samples=20)
    ds["y"][:] = np.nan
    found = answer(with_status(ds, range(20), Status.RAISED))
    assert found.quantities == () and found.rows_sentence == "20 of 20 rows failed."
    assert [one.rule for one in found.advice] == ["failed"]
    assert "20 of 20 rows failed." in repr(found) and "20 of 20" in found._repr_html_()


def test_inputs_that_indices_do_not_tell_apart_are_named_together():
    ds = linear("saltelli", samples=64, replicates=4)
    ds = with_output(ds, "even", ds["x1"].values + ds["x2"].values)
    ranking = answer(asking(ds, outputs=["even"])).lead.ranking
    assert set(ranking.contributions[0].inputs) == {"x1", "x2"}
    assert ranking.sentence.startswith(("x1 and x2 contribute most", "x2 and x1 contribute most"))


def test_an_index_that_is_not_settled_ranks_nothing_and_says_what_would_settle_it():
    rng = np.random.default_rng(0)
    ds = linear("saltelli", samples=8, replicates=4)
    ds = with_output(ds, "wild", rng.standard_cauchy(ds.sizes["sample"]).clip(-50, 50))
    found = answer(asking(ds, outputs=["wild"]))
    assert found.lead.ranking.leader is None and found.lead.ranking.rows_factor > 1
    assert "not settled" in found.lead.ranking.sentence
    (rows,) = [one for one in found.advice if one.rule == "rows"]
    said = re.match(r"Compute (?:about|more than) ([\d ]+) rows instead of (\d+): ", rows.text)
    assert int(said[1].replace(" ", "")) >= rows.rows - 1 > int(said[2])


def test_a_rare_event_asks_for_more_rows():
    ds = linear(samples=200)
    ds = with_output(ds, "rare", np.r_[np.ones(8), np.zeros(192)] + 1e-6 * ds["x1"].values)
    found = answer(asking(ds, outputs=["rare"], thresholds={"rare": 0.5}))
    share = found.lead.events[0].share
    half = (share.high - share.low) / 2
    (rows,) = [one for one in found.advice if one.rule == "rows"]
    assert rows.rows == pytest.approx(200 * (half / 0.01) ** 2, rel=0.01)


def with_valley(samples=400):
    """Return a result in which a wanted y is high where x4 is far from its middle."""
    ds = linear(samples=samples)
    far = (ds["x4"].values - 0.5) ** 2 + 1e-4 * ds["x1"].values
    asked = {"outputs": ["far"], "thresholds": {"far": 0.01}, "wanted": {"far": "above"}}
    return asking(with_output(ds, "far", far), **asked)


def test_where_less_scatter_does_not_help_the_answer_says_where_to_keep_the_input():
    ds = with_valley()
    found = answer(ds)
    assert [one.rule for one in found.advice][:1] == ["keep"]
    event = found.lead.events[0]
    assert event.share.value > 0.5
    share, low, high = numbers(
        r"So that more exceed 10 mm, keep x4 [^:]*: # % \(# to # %\) do there\.",
        found.advice[0].text,
    )
    most = event.curve.shares[event.curve.most]
    assert [share, low, high] == pytest.approx([100 * one for one in most.numbers], abs=0.05)
    assert most.low > event.share.high


@pytest.mark.parametrize(("wanted", "side"), [("above", "stay above"), ("below", "stay below")])
def test_the_side_that_is_wanted_is_promised_and_advised(wanted, side):
    asked = {"outputs": ["y"], "thresholds": {"y": 5.0}, "wanted": {"y": wanted}}
    found = answer(asking(linear(samples=400), **asked))
    bound = rf"With 95 % confidence, at least 95 % {side} [\d.]+\."
    assert re.fullmatch(bound, found.lead.promise.sentence)
    (one,) = (each for each in found.advice if each.rule in ("tighten", "keep"))
    if one.rule == "tighten":
        before, after = one.tightened.before.value, one.tightened.after.value
        assert after > before if wanted == "above" else after < before
    else:
        assert one.text.startswith(f"So that {'more' if wanted == 'above' else 'fewer'} exceed 5")


def test_what_nobody_wants_is_not_called_better():
    ds = with_valley()
    found = answer(asking(ds, outputs=["far"], thresholds={"far": 0.01}, wanted={}))
    assert found.lead.wants_more is None
    assert not any(one.rule == "keep" for one in found.advice)


def test_a_large_angle_may_be_wanted():
    asked = {"outputs": ["angle"], "thresholds": {"angle": 1.0}}
    assert answer(kinds(samples=100, analysis=asked)).lead.wants_more is False
    lead = answer(kinds(samples=100, analysis=asked | {"wanted": {"angle": "above"}})).lead
    assert lead.wants_more and "at least 95 % exceed" in lead.promise.sentence


def test_more_successes_and_fewer_other_ends_are_better():
    lives = np.random.default_rng(0).uniform(1, 9, 64)
    ds = with_output(linear(samples=64), "life", lives, "lifetime")
    asked = {"outputs": ["life"], "thresholds": {"life": 8.0}}
    lead = answer(asking(ds, **asked)).lead
    assert not lead.wants_more
    ds["life"].attrs["success"] = "the lock has closed"
    lead = answer(asking(ds, **asked)).lead
    assert lead.wants_more
    better = Tightened(("x",), "", Estimate(0.5), Estimate(0.6), wants_more=True)
    assert better.helps and not replace(better, wants_more=False).helps
    assert replace(better, wants_more=None).helps


def test_an_effect_without_a_direction_has_no_size():
    assert Change(0, "10 %", Estimate(1.0, -1.0, 3.0)).sentence() == "no clear direction"
    assert Change(1).sentence("rate") == "more rate raises it"


def test_twins_are_named_together():
    assert called_together(["bearing_constant_1", "bearing_constant_2"]) == "both bearing constants"
    assert called_together(["unbalance_1"]) == "unbalance 1"
    assert called_together(["a", "b_1", "c"]) == "a, b 1 and c"
    assert called_together(["b_2", "c_1", "b_1", "a"]) == "both bs, c 1 and a"


def test_bounds_are_rounded_to_the_safe_side():
    assert rounded(1.1879, -np.inf) == "1.18" and rounded(1.1821, np.inf) == "1.19"
    assert rounded(1.18, -np.inf) == rounded(1.18, np.inf) == "1.18"
    assert rounded(-0.0012345, -np.inf) == "-0.00124"
    assert (rounded(5e-324), rounded(1.7976e308, np.inf)) == ("4.94e-324", "1.8e+308")
    one = Promise(0.95, 0.95, np.nan, 1.1821, Unit("m"))
    assert one.sentence == "With 95 % confidence, at least 95 % stay below 1.19 m."


def test_numbers_of_rows_are_rounded_up():
    assert [rows_in_words(n) for n in (8, 59, 1234, 98765)] == ["8", "59", "1 300", "99 000"]


def test_nothing_is_said_of_an_event_without_rows():
    assert Event("P(y>1.0)", "exceed 1", Estimate()).sentence == ""
    assert Ranking("y", "sobol").sentence == ""


def test_undefined_rows_are_named_beside_a_probability():
    turn = np.random.default_rng(1).uniform(-0.5, 0.5, 200)
    turn[:50] = np.nan
    ds = with_output(linear(samples=200), "turn", turn, "angle")
    ds["turn"].attrs |= {"units": "rad", "may_be_undefined": 1}
    ds = asking(ds, outputs=["turn"], thresholds={"turn": "20 degrees"})
    (event,) = answer(ds).lead.events
    share, _, _, undefined = numbers(
        r"# % \(# to # %\) exceed 20° in magnitude; # % are undefined\.", event.sentence
    )
    known = summarised(ds)["outputs"]["turn"]["thresholds"][repr(event_at(event))]
    assert share == pytest.approx(100 * known["above"]["value"], abs=0.05)
    assert undefined == 100 * known["undefined"] == 25


def event_at(event):
    return float(event.name.partition(">")[2].rstrip(")"))


def test_a_notebook_shows_the_same_sentences():
    found = uq.answer(linear("saltelli", samples=64, replicates=4))
    html = found._repr_html_()
    assert html.startswith("<style>") and printed(found.lead.range.sentence) in html
    assert found.lead.range.sentence in repr(found)


def test_a_large_design_ranks_inputs_by_its_first_rows(monkeypatch):
    ds = linear(samples=400)
    monkeypatch.setattr(findings, "RANKED", 300)
    few = answer(ds).lead.ranking
    alone = answer(findings.first_samples(ds, 300)).lead.ranking
    assert few.contributions == alone.contributions
    assert few.what == f"{alone.what}, by the first 300 rows"
