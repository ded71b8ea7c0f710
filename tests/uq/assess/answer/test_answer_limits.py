"""In which range of the input that decides an event it is rare on average, against known curves."""

import numpy as np
import pytest
from answered import locking, numbers
from computed import asking, linear, with_output

from uq import answer, summary, trace
from uq.assess.answer.limits import limit_of
from uq.assess.answer.wording import DisplayUnit
from uq.assess.effects import EventCurve, event_curve
from uq.stats.estimate import Estimate


def limit(chance, rows=4000, seed=0, is_unwanted=True):
    """Return the limit of an event that has this chance at each x in [0, 1]."""
    random = np.random.default_rng(seed)
    x = random.random(rows)
    hits = (random.random(rows) < chance(x)).astype(float)
    return limit_of(event_curve(hits, x), "power", DisplayUnit(), "fail", is_unwanted)


def falling(x):
    return 1 / (1 + np.exp(20 * (x - 0.5)))  # 5 % at 0.5 + log(19) / 20 = 0.647


def test_the_range_of_a_known_curve_is_rare_on_average():
    result = limit(falling)
    low, high = numbers(
        r"With 95 % confidence, fewer than 5 % fail on average if power is between # and #\.",
        result.sentence,
    )
    assert low == pytest.approx(result.at, abs=0.01) and high == pytest.approx(result.end, abs=0.01)
    assert 0.55 < result.at < 0.75 and result.end > 0.99
    other = limit(lambda x: falling(1 - x))
    assert "is between 0.00" in other.sentence and other.end < 0.01 < 0.25 < other.at < 0.45
    assert limit(lambda x: 1 - falling(x), is_unwanted=False).at == pytest.approx(
        result.at, abs=0.1
    )


@pytest.mark.parametrize(
    "chance",
    [falling, lambda x: np.minimum(1.0, 3 * (1 - x) ** 2), lambda x: 0.3 * (x < 0.6)],
)
def test_the_average_over_the_range_is_rare(chance):
    """It is larger in at most 2.5 % of repetitions."""
    results = [limit(chance, rows=2400, seed=seed) for seed in range(300)]
    limits = [result for result in results if not result.why]
    means = [chance(np.linspace(result.at, 1, 1000)).mean() for result in limits]
    assert len(limits) > 150 and np.mean(np.array(means) < 0.05) >= 0.975


def wanted_end(chance, **options):
    """Return the ends of the part at the wanted end, and the interval of the share that fails."""
    sentence = limit(chance, **options).sentence
    settled_sentence = sentence.replace("; it is not settled whether fewer than 5 % do", "")
    many, *ends = numbers(
        r"In the highest of # parts of power \(# to #\), # to # % fail on average\.",
        settled_sentence,
    )
    assert many == 12
    return ends


def test_of_the_part_at_the_wanted_end_the_average_alone_is_known():
    """At the last values fewer than 5 % fail, at the very last none."""
    first, last, low, high = wanted_end(lambda x: np.minimum(1.0, 3 * (1 - x)))
    assert first == pytest.approx(11 / 12, abs=0.02) and last == pytest.approx(1, abs=0.002)
    assert 5 < low < 100 * 3 / 24 < high < 20


@pytest.mark.slow
@pytest.mark.parametrize("least", [0.05, 0.3])
def test_the_interval_covers_the_average_at_the_wanted_end(least):
    covered = []
    for seed in range(400):
        *_, low, high = wanted_end(lambda x: least + 0.7 * (1 - x), seed=seed)
        covered.append(low / 100 <= least + 0.7 / 24 <= high / 100)
    assert np.mean(covered) >= 0.92


def test_a_spike_within_the_range_denies_no_average():
    """At a few values all fail, where the range is rare on average."""
    result = limit(lambda x: np.where(x > 0.9999, 1.0, np.where(x < 0.5, 1 - x, 0.01)), rows=12000)
    assert result.at < 0.6 and " fail on average if " in result.sentence


@pytest.mark.parametrize(
    ("chance", "sentence"),
    [
        (
            lambda x: 0.02 + 0.5 * np.sin(np.pi * x) + 0.3 * (x > 0.95),
            "No limit of power: the share that fail is not monotonic in it.",
        ),
        (
            lambda x: 0.05 + 0.6 * (1 - x),
            "In the highest of 12 parts of power (0.913 to 1), 3.5 to 8.7 % fail on average;"
            " it is not settled whether fewer than 5 % do.",
        ),
    ],
)
def test_where_there_is_no_limit_a_sentence_says_so(chance, sentence):
    assert limit(chance).sentence == sentence


def test_on_a_plateau_no_part_is_called_the_best():
    """Beyond the step all parts have the same share, and the last is often not the smallest."""
    for seed in range(8):
        sentence = limit(lambda x: np.where(x < 0.3, 0.7, 0.055), rows=1200, seed=seed).sentence
        assert "best" not in sentence and "Even" not in sentence


def test_what_is_rare_everywhere_needs_no_limit():
    assert limit(lambda x: 0.01 * (1 - x)) is None


def test_a_few_rows_settle_no_limit():
    assert "is not settled" in limit(falling, rows=80).sentence


def test_how_weak_the_motors_may_be():
    ds = locking(samples=1000)
    conclusions = answer(ds)
    event = conclusions.lead.events[0]
    low, high = numbers(
        r"With 95 % confidence, more than 95 % succeed within 20 s on average if x4 is between"
        r" # and #\.",
        event.limited,
    )
    assert 0.25 < low < 0.45 and high > 0.99
    assert event.limited in repr(conclusions)
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
        assert event.limited.startswith("With 95 % confidence, more than 95 % exceed") == (
            side == "above"
        )
    assert at["below"] < 0.7 < at["above"]


def test_one_part_that_alone_is_rare_is_a_range():
    common, rare = Estimate(0.5, 0.4, 0.6), Estimate(0.01, 0.0, 0.04)
    curve = EventCurve(np.array([0.0, 1.0, 2.0]), [common, rare])
    sentence = limit_of(curve, "power", DisplayUnit(), "fail", True).sentence
    assert sentence.endswith("fewer than 5 % fail on average if power is between 1 and 2.")


def test_a_value_is_a_limit_where_the_event_is_rare_at_it():
    grade = np.repeat([1.0, 2.0, 3.0], [600, 300, 100])
    for worst, bound in ((3.0, "at most 2.5"), (2.0, "at most 1.5")):
        hits = (grade >= worst).astype(float)
        result = limit_of(event_curve(hits, grade), "grade", DisplayUnit(), "fail", True)
        assert result.sentence == f"With 95 % confidence, fewer than 5 % fail if grade is {bound}."


def test_without_intervals_no_limit_is_denied():
    shares = [Estimate(share) for share in (0.3, 0.1, 0.0, 0.0)]
    result = limit_of(EventCurve(np.arange(5.0), shares), "power", DisplayUnit(), "fail", True)
    assert result.sentence == (
        "It is not settled whether fewer than 5 % fail if power is between 3 and 4."
    )
