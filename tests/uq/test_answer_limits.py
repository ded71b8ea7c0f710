"""From which value of the input that decides an event it is rare, against known curves."""

import numpy as np
import pytest
from answered import locking, numbers
from computed import asking, linear, with_output

from uq import answer, summary, trace
from uq.analysis.event_curve import EventCurve, event_curve
from uq.conclusions.limits import limit_of
from uq.conclusions.words import Unit
from uq.estimate import Estimate


def limit(chance, rows=4000, seed=0, is_unwanted=True):
    """Return the limit of an event that has this chance at each x in [0, 1]."""
    random = np.random.default_rng(seed)
    x = random.random(rows)
    hits = (random.random(rows) < chance(x)).astype(float)
    return limit_of(event_curve(hits, x), "power", Unit(), "fail", is_unwanted)


def falling(x):
    return 1 / (1 + np.exp(20 * (x - 0.5)))  # 5 % at 0.5 + log(19) / 20 = 0.647


def test_the_limit_of_a_known_curve_lies_where_it_says():
    found = limit(falling)
    at, low, high = numbers(
        r"Surely fewer than 5 % fail where power is at least # "
        r"\(the limit lies between # and #\)\.",
        found.sentence,
    )
    assert low < 0.5 + np.log(19) / 20 < high == at < 0.9
    other = limit(lambda x: falling(1 - x))
    assert "at most 0." in other.sentence and other.at < 1 - 0.647 < other.until
    assert limit(lambda x: 1 - falling(x), is_unwanted=False).at == pytest.approx(found.at, abs=0.1)


def test_the_band_of_the_limit_holds_it():
    """Each end is wrong in at most 2.5 % of repetitions."""
    found = [limit(falling, rows=1200, seed=seed) for seed in range(300)]
    known = [one for one in found if not one.why]
    held = [one.until < 0.5 + np.log(19) / 20 < one.at for one in known]
    assert len(known) > 150 and np.mean(held) >= 0.95


@pytest.mark.parametrize(
    ("chance", "said"),
    [
        (lambda x: 0.2 + 0.6 * (1 - x), "No value of power lets fewer than 5 % fail."),
        (
            lambda x: 0.02 + 0.5 * np.sin(np.pi * x) + 0.3 * (x > 0.95),
            "No limit of power: how many fail does not change steadily with it.",
        ),
        (
            lambda x: 0.05 + 0.6 * (1 - x) ** 2,
            "Whether a value of power lets fewer than 5 % fail is not settled.",
        ),
    ],
)
def test_where_there_is_no_limit_a_sentence_says_so(chance, said):
    assert limit(chance).sentence == said


def test_what_is_rare_everywhere_needs_no_limit():
    assert limit(lambda x: 0.01 * (1 - x)) is None


def test_a_few_rows_settle_no_limit():
    assert "is not settled" in limit(falling, rows=80).sentence


def test_how_weak_the_motors_may_be():
    ds = locking(samples=1000)
    found = answer(ds)
    event = found.lead.events[0]
    at, low, high = numbers(
        r"Surely more than 95 % succeed within 20 s where x4 is at least # "
        r"\(the limit lies between # and #\)\.",
        event.limited,
    )
    assert low <= 0.3 <= high == at < 0.45
    assert event.limited in repr(found)
    key = f"answer/quantities/locking/events/{event.name}/limit/at"
    assert trace(ds, key)["value"] == event.limit.at
    assert summary(ds).loc["locking", "never"] == (ds["x4"].values <= 0.3).sum()


def test_no_side_is_unwanted_where_the_study_states_none():
    ds = linear(samples=1000)
    ds = with_output(ds, "level", ds["x4"].values + 1e-3 * ds["x1"].values)
    asked = {"outputs": ["level"], "thresholds": {"level": 0.7}}
    assert answer(asking(ds, **asked)).lead.events[0].limit is None
    at = {}
    for side in ("below", "above"):
        (event,) = answer(asking(ds, **asked, wanted={"level": side})).lead.events
        at[side] = event.limit.at
        assert event.limited.startswith("Surely more than 95 % exceed") == (side == "above")
    assert at["below"] < 0.7 < at["above"]


def test_one_part_that_alone_is_rare_settles_nothing():
    """Within it, the probability at its inner end may still be larger."""
    common, rare = Estimate(0.5, 0.4, 0.6), Estimate(0.01, 0.0, 0.04)
    curve = EventCurve(np.array([0.0, 1.0, 2.0]), [common, rare])
    assert limit_of(curve, "power", Unit(), "fail", True).why.endswith("is not settled")


def test_a_value_is_a_limit_where_the_event_is_rare_at_it():
    grade = np.repeat([1.0, 2.0, 3.0], [600, 300, 100])
    for worst, said in ((3.0, "at most 2.5"), (2.0, "at most 1.5")):
        hits = (grade >= worst).astype(float)
        found = limit_of(event_curve(hits, grade), "grade", Unit(), "fail", True)
        assert found.sentence == f"Surely fewer than 5 % fail where grade is {said}."


def test_without_intervals_no_limit_is_denied():
    shares = [Estimate(one) for one in (0.3, 0.1, 0.0, 0.0)]
    found = limit_of(EventCurve(np.arange(5.0), shares), "power", Unit(), "fail", True)
    assert found.sentence == "Whether a value of power lets fewer than 5 % fail is not settled."
