"""What of a lifetime has indices: its logarithm or rank, and whether it ends before a time."""

import numpy as np
import pytest
from asked_indices import indices, values
from computed import asking, kinds, linear, with_output
from scipy import stats

from uq.errors import InputError


def lives(values, censored=None, thresholds=()):
    ds = linear("saltelli", samples=64, replicates=4)
    life = with_output(ds, "life", values(ds["y"].values), "lifetime", censored)
    return asking(life, outputs=["life"], thresholds={"life": list(thresholds)})


def alone(ds, values):
    """Return the total indices of these numbers as an output of its own."""
    ds = asking(with_output(ds, "number", values), outputs=["number"])
    (entry,) = indices(ds, output="number")["outputs"].values()
    return [index["value"] for index in entry["ST"].values()]


def test_lives_that_all_end_are_judged_by_logarithm_and_by_the_studys_own_times():
    ds = lives(lambda y: 1 / y**4, thresholds=[0.001, 0.01])
    outputs = indices(ds)["outputs"]
    assert list(outputs) == ["log(life)", "P(life<0.001)", "P(life<0.01)"]
    assert values(outputs["log(life)"], "ST") == pytest.approx(alone(ds, np.log(ds["y"].values)))
    assert values(outputs["P(life<0.01)"], "ST") == pytest.approx(alone(ds, ds["life"] < 0.01))
    assert not any("logarithm" in note for note in outputs["log(life)"]["notes"])


def test_lives_that_may_never_end_are_judged_by_rank():
    ds = lives(
        lambda y: np.where(y > 1, 1 / np.maximum(y - 1, 1e-9), np.inf), thresholds=[0.2, 0.5]
    )
    outputs = indices(ds)["outputs"]
    assert list(outputs) == ["rank(life)", "P(life<0.2)", "P(life<0.5)"]
    ranks = stats.rankdata(-np.maximum(ds["y"].values, 1))
    assert values(outputs["rank(life)"], "ST") == pytest.approx(alone(ds, ranks))
    never = int(np.isinf(ds["life"]).sum())
    assert f"{never} rows that never end" in outputs["rank(life)"]["notes"][0]
    refused = indices(ds, output="log(life)")["outputs"]["log(life)"]["refused"]
    assert f"{never} never end" in refused and "rank(life)" in refused
    # The rate of a life that never ends is 0; here it is max(y - 1, 0).
    rate = indices(ds, output="rate(life)")["outputs"]["rate(life)"]
    expected = alone(ds, np.maximum(ds["y"].values - 1, 0.0))
    assert values(rate, "ST") == pytest.approx(expected, rel=1e-6)


def test_names_of_lifetimes_carry_their_element():
    ds = kinds("monte-carlo", 128, analysis={"thresholds": {"life": 1e6}})
    names = list(indices(ds)["outputs"])
    assert names[:3] == ["work[side=left]", "work[side=right]", "work[:]"]
    assert names[3:5] == [
        "rank(life[side=left,depth=0.5])",
        "P(life[side=left,depth=0.5]<1000000.0)",
    ]
    assert names[-3:] == ["angle", "P(regime=slow)", "P(regime=fast)"]
    assert len(names) == 3 + 9 + 1 + 2


def test_lives_censored_at_one_horizon_share_the_highest_rank():
    def censored_at_a_third(ds_values):
        return np.minimum(1 / ds_values, 1 / 3)

    free = lives(lambda y: 1 / y)
    censored = 1 / free["y"].values > 1 / 3
    ds = lives(censored_at_a_third, censored, [0.2, 0.33, 0.7])
    outputs = indices(ds)["outputs"]
    assert values(outputs["rank(life)"], "ST") == pytest.approx(
        alone(ds, stats.rankdata(censored_at_a_third(ds["y"].values)))
    )
    assert f"{censored.sum()} of 1536 rows" in outputs["P(life<0.7)"]["refused"]
    for name in ("P(life<0.2)", "P(life<0.33)"):
        assert outputs[name]["ST"]["x4"]["value"] > 0.2
    for name in ("log(life)", "rate(life)"):
        assert "censored" in indices(ds, output=name)["outputs"][name]["refused"]


def test_ranks_of_rows_censored_while_others_end_are_not_known():
    early = np.arange(1536) % 7 == 0
    ds = lives(lambda y: np.where(early, 0.01, 1 / y), early, [0.005])
    outputs = indices(ds)["outputs"]
    assert (
        f"{early.sum()} rows censored before the last life ended"
        in outputs["rank(life)"]["refused"]
    )
    assert "same value" in outputs["P(life<0.005)"]["refused"]


def test_rows_without_a_life_drop_their_groups_from_every_target():
    ds = lives(lambda y: np.where(y > 9, np.nan, 1 / y), thresholds=[0.2])
    lacking = np.isnan(ds["life"].values.reshape(-1, 6)).any(axis=1).sum()
    for name in ("log(life)", "P(life<0.2)"):
        assert indices(ds)["outputs"][name]["groups_dropped"] == lacking > 0
    assert indices(ds, output="rank(life)")["outputs"]["rank(life)"]["groups_dropped"] == lacking


def test_an_event_that_never_or_always_happens_is_refused():
    outputs = indices(lives(lambda y: 1 + y, thresholds=[0.5, 100.0]))["outputs"]
    assert "same value" in outputs["P(life<0.5)"]["refused"]
    assert "same value" in outputs["P(life<100.0)"]["refused"]


def test_lives_of_zero_have_no_logarithm_and_no_rate():
    ds = lives(lambda y: np.where(y > 5, 0.0, y))
    assert list(indices(ds)["outputs"]) == ["rank(life)"]
    zero = indices(ds, output="rate(life)")["outputs"]["rate(life)"]
    assert "lifetime zero" in zero["refused"]
    zero = indices(ds, output="log(life)")["outputs"]["log(life)"]
    assert "are not positive" in zero["refused"]


def test_lives_whose_rate_overflows_are_refused():
    ds = lives(lambda y: 1e-308 * (1 + y))
    rate = indices(ds, output="rate(life)")["outputs"]["rate(life)"]
    assert "lifetime zero or below 1e-300 s: no rate" in rate["refused"]


def test_events_are_named_with_spaces_and_units_and_others_are_refused():
    ds = asking(kinds("saltelli", replicates=4), thresholds={"work": 0.5, "life": 1.0})
    element = "work[side=left]"
    (name,) = indices(ds, output=f"P( {element} > 0.5 )")["outputs"]
    assert name == f"P({element}>0.5)"
    (name,) = indices(ds, output="P(life[side=left,depth=0.5] < 1 s)")["outputs"]
    assert name == "P(life[side=left,depth=0.5]<1.0)"
    with pytest.raises(InputError, match=r"no such event .*>0.7.*allowed: P\(work.*>0.5\).*thresh"):
        indices(ds, output=f"P({element} > 0.7)")
    with pytest.raises(InputError, match="the unit 'm' does not fit 'life'"):
        indices(ds, output="P(life[side=left,depth=0.5] < 1 m)")
