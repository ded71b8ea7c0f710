"""Which rows and numbers of two results a comparison takes, and what it says of the others."""

import numpy as np
import pytest
from computed import asking, compared, kinds, linear, with_output, with_status
from nested_studies import nested_result

from uq.assess.pairing import Pairing, pairing
from uq.contract import Status
from uq.result.result import Result
from uq.stats.intervals import wilson_interval

ENDS = ("value", "low", "high")


def apart(pair_of_estimates):
    """Return the difference of an estimate, and the ends of its interval."""
    return [pair_of_estimates["difference"][end] for end in ENDS]


def test_what_one_study_asks_for_is_compared():
    pair = [linear(analysis={"thresholds": {"y": t}}) for t in (4.0, 6.0)]
    assert list(compared(*pair)["outputs"]["y"]["thresholds"]) == ["4.0", "6.0"]
    probability = compared(pair[0], linear())["outputs"]["y"]["thresholds"]["4.0"]["above"]
    assert apart(probability)[0] == 0.0


def test_rows_that_failed_count_no_more_than_rows_that_are_not_there():
    asked = {"outputs": ["angle", "regime"], "thresholds": {"angle": 0.5}}
    whole, lost = kinds(samples=200, analysis=asked), np.arange(40)
    other = whole.assign(regime=whole["regime"].copy(), angle=whole["angle"] ** 1.1)
    other["angle"].attrs = whole["angle"].attrs
    other["regime"][90:120] = 1
    failing = with_status(other, lost, Status.RAISED)
    failing["regime"][lost], failing["angle"][lost], failing["work"][lost] = -1, np.nan, np.nan
    comparison = compared(whole, failing)
    without = compared(whole, other.isel(row=slice(40, None)))
    assert comparison["b"]["status"]["raised"] == 40
    for label in ("slow", "fast"):
        expected = pytest.approx(apart(without["regime"][label]), rel=1e-9)
        assert apart(comparison["regime"][label]) == expected
    sides, expected = (
        comparison_["outputs"]["angle"]["thresholds"]["0.5"]["above"]
        for comparison_ in (comparison, without)
    )
    assert apart(sides) == pytest.approx(apart(expected), rel=1e-9)


def test_shares_that_agree_have_newcombes_interval():
    # R. G. Newcombe, Stat. Med. 17, 2635 (1998), method 10: half a row counts against agreement.
    both, first, second, none = counts = (20, 2, 12, 16)
    n = sum(counts)
    ds = linear(samples=n)
    hits = [np.repeat(pattern, counts) for pattern in ([1.0, 1.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0])]
    pair = [asking(with_output(ds, "hit", hit), thresholds={"hit": 0.5}) for hit in hits]
    a, b = (hit.mean() for hit in hits)
    phi = (both * none - first * second - n / 2) / (n**2 * np.sqrt(a * (1 - a) * b * (1 - b)))

    def end(share, other):
        return np.sqrt(share**2 - 2 * phi * share * other + other**2)

    (low_a, high_a), (low_b, high_b) = (wilson_interval(share, n) for share in (a, b))
    expected = [b - a, b - a - end(b - low_b, high_a - a), b - a + end(high_b - b, a - low_a)]
    probability = compared(*pair)["outputs"]["hit"]["thresholds"]["0.5"]["above"]
    assert apart(probability) == pytest.approx(expected)


def test_lives_that_assume_something_count_at_their_worst():
    def lives(factor):
        values = factor * np.linspace(1, 5, 200)
        ds = with_output(linear(samples=200), "life", values, "lifetime", np.arange(200) % 3 == 0)
        return asking(ds, outputs=["life"])

    b50 = compared(lives(1.0), lives(1.5))["outputs"]["life"]["b_lives"]["B50"]
    a, b = b50["a"], b50["b"]
    assert "assumes" in a and "assumes" in b
    assert apart(b50)[1:] == pytest.approx([b["low"] - a["high"], b["high"] - a["low"]])


def test_elements_of_one_result_alone_are_named():
    both, left = kinds(samples=50), kinds(samples=50).isel(side=[0])
    for pair, which in (((both, left), "A"), ((left, both), "B")):
        comparison = compared(*pair)
        (note,) = [note for note in comparison["notes"] if note.startswith("Only ")]
        assert note.startswith(f"Only {which} has work[side=right], life[side=right,depth=0.5]")
        assert "work[side=left]" in comparison["outputs"]
        assert "work[side=right]" not in comparison["outputs"]


def test_replicates_are_pairs_only_where_both_results_have_as_many():
    four, eight = (linear("sobol", samples=16, replicates=count) for count in (4, 8))
    assert (
        pairing(Result(four), Result(linear("halton", samples=32, replicates=4)))
        is Pairing.REPLICATES
    )
    assert pairing(Result(four), Result(eight)) is Pairing.UNKNOWN


@pytest.mark.parametrize(("method", "replicates"), [("monte-carlo", 1), ("sobol", 4)])
def test_identical_rows_are_said_to_be_so_and_have_no_interval_of_no_width(method, replicates):
    ds = asking(linear(method, replicates=replicates), thresholds={"y": 5.0})
    statistics = compared(ds, ds)["outputs"]["y"]
    same = {"value": 0.0, "low": None, "high": None, "identical": True}
    assert statistics["mean"]["difference"] == statistics["sd"]["difference"] == same
    assert statistics["sd"]["ratio"] == same | {"value": 1.0}
    assert statistics["quantiles"]["0.5"]["difference"] == same
    assert statistics["thresholds"]["5.0"]["above"]["difference"] == same
    # A shift that is the same in every pair is known, but nothing shows how well.
    moved = compared(ds, with_output(ds, "y", ds["y"].values + 0.5))["outputs"]["y"]
    assert moved["mean"]["difference"]["value"] == pytest.approx(0.5)
    assert moved["mean"]["difference"]["low"] is moved["mean"]["difference"]["high"] is None
    assert "identical" not in moved["mean"]["difference"]


@pytest.mark.parametrize(("method", "replicates"), [("monte-carlo", 1), ("sobol", 4)])
def test_rows_that_differ_but_change_no_side_are_not_identical(method, replicates):
    ds = asking(linear(method, replicates=replicates), thresholds={"y": 5.0})
    moved = with_output(ds, "y", 5.0 + 0.99 * (ds["y"].values - 5.0))
    both, n = kinds(method, replicates=replicates), ds.sizes["row"]
    other = with_output(both, "angle", 0.5 * both["angle"].values)
    most = 1 - 0.025 ** (1 / n)
    assert most == pytest.approx(3.7 / n, rel=0.04)
    for estimate in (
        compared(ds, moved)["outputs"]["y"]["thresholds"]["5.0"]["above"]["difference"],
        compared(both, other)["regime"]["slow"]["difference"],
    ):
        assert estimate.pop("no_row_changes_sides")
        assert estimate == pytest.approx({"value": 0.0, "low": -most, "high": most})
    same = compared(both, both)["regime"]["slow"]["difference"]
    assert same == {"value": 0.0, "low": None, "high": None, "identical": True}


def test_a_nested_result_is_identical_to_itself_alone():
    ds = nested_result(samples=30)
    comparison = compared(ds, ds)
    assert (
        comparison["pairing"] == "rows"
        and "Both results have the same rows." in comparison["notes"]
    )
    same = {"value": 0.0, "low": None, "high": None, "identical": True}
    assert comparison["outputs"]["y"]["mean"]["difference"] == same
    moved = with_output(ds, "y", ds["y"].values + np.arange(ds.sizes["row"]) % 2)
    comparison = compared(ds, moved)
    assert comparison["pairing"] == "unknown"
    assert comparison["outputs"]["y"]["mean"]["difference"]["low"] < 0.5


def censored_lives(times, censored=True):
    """Return a result of which every third life is censored, or ends, at some time."""
    lost = np.arange(200) % 3 == 0
    values = np.where(lost, times, np.linspace(1, 5, 200))
    ds = with_output(linear(samples=200), "life", values, "lifetime", lost & censored)
    return asking(ds, outputs=["life"], thresholds={"life": 4.0})


def test_lives_censored_before_a_threshold_can_be_compared():
    early, late = censored_lives(2.0), censored_lives(3.0)
    below = compared(early, late)["outputs"]["life"]["thresholds"]["4.0"]["below"]
    assert below["a"]["value"] != below["b"]["value"]
    assert below["difference"]["value"] == pytest.approx(below["b"]["value"] - below["a"]["value"])
    assert below["difference"]["low"] < below["difference"]["value"] < below["difference"]["high"]
    same = compared(early, early)["outputs"]["life"]["thresholds"]["4.0"]["below"]["difference"]
    assert same == {"value": 0.0, "low": None, "high": None, "identical": True}
    for pair in ((early, censored_lives(9.0)), (censored_lives(9.0), early)):  # known in one alone
        below = compared(*pair)["outputs"]["life"]["thresholds"]["4.0"]["below"]
        assert below["difference"]["value"] is not None


def test_rows_censored_at_other_times_are_not_identical():
    pair = censored_lives(2.0), censored_lives(3.0)
    b50 = compared(*pair)["outputs"]["life"]["b_lives"]["B50"]
    assert b50["a"]["value"] != b50["b"]["value"] and "identical" not in b50["difference"]
    assert b50["difference"]["value"] == pytest.approx(b50["b"]["value"] - b50["a"]["value"])
