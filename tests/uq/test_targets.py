"""What of a lifetime has indices: its rate, and whether it ends before a time."""

import numpy as np
import pytest
from asked_indices import indices, values
from computed import asking, kinds, linear, with_output


def lives(values, censored=None, thresholds=()):
    ds = linear("saltelli", samples=64, replicates=4)
    life = with_output(ds, "life", values(ds["y"].values), "lifetime", censored)
    return asking(life, outputs=["life"], thresholds={"life": list(thresholds)})


def test_lifetimes_are_judged_by_rate_and_by_the_studys_own_times():
    ds = lives(
        lambda y: np.where(y > 1, 1 / np.maximum(y - 1, 1e-9), np.inf), thresholds=[0.2, 0.5]
    )
    found = indices(ds)["outputs"]
    assert list(found) == ["rate(life)", "P(life<0.2)", "P(life<0.5)"]
    # The rate of a life that never ends is 0; here the rate is max(y - 1, 0).
    by_rate = with_output(ds, "rate", np.maximum(ds["y"].values - 1, 0.0))
    by_rate = asking(by_rate, outputs=["rate"])
    assert values(found["rate(life)"], "ST") == pytest.approx(
        values(indices(by_rate)["outputs"]["rate"], "ST"), rel=1e-6
    )
    event = with_output(ds, "event", ds["life"].values < 0.2)
    event = indices(asking(event, outputs=["event"]))["outputs"]["event"]
    assert found["P(life<0.2)"]["ST"] == event["ST"]


def test_names_of_lifetimes_carry_their_element():
    ds = kinds("monte-carlo", 128, analysis={"thresholds": {"life": 1e6}})
    names = list(indices(ds)["outputs"])
    assert names[:2] == ["work[side=left]", "work[side=right]"]
    assert names[2:4] == [
        "rate(life[side=left,depth=0.5])",
        "P(life[side=left,depth=0.5]<1000000.0)",
    ]
    assert names[-3:] == ["angle", "P(regime=slow)", "P(regime=fast)"]
    assert len(names) == 2 + 8 + 1 + 2


def test_censored_lives_have_no_rate_but_may_have_a_probability():
    def censored_at_half(ds_values):
        return np.minimum(1 / ds_values, 0.5)

    free = lives(lambda y: 1 / y)
    censored = 1 / free["y"].values > 0.5
    found = indices(lives(censored_at_half, censored, [0.3, 0.5, 0.7]))["outputs"]
    assert "censored" in found["rate(life)"]["refused"]
    assert f"{censored.sum()} of 1536 rows" in found["P(life<0.7)"]["refused"]
    for name in ("P(life<0.3)", "P(life<0.5)"):
        assert found[name]["ST"]["x4"]["value"] > 0.2


def test_rows_without_a_life_drop_their_groups_from_every_target():
    ds = lives(lambda y: np.where(y > 9, np.nan, 1 / y), thresholds=[0.2])
    lacking = np.isnan(ds["life"].values.reshape(-1, 6)).any(axis=1).sum()
    for name in ("rate(life)", "P(life<0.2)"):
        assert indices(ds)["outputs"][name]["groups_dropped"] == lacking > 0


def test_an_event_that_never_or_always_happens_is_refused():
    found = indices(lives(lambda y: 1 + y, thresholds=[0.5, 100.0]))["outputs"]
    assert "same value" in found["P(life<0.5)"]["refused"]
    assert "same value" in found["P(life<100.0)"]["refused"]
    zero = indices(lives(lambda y: np.where(y > 5, 0.0, y)))["outputs"]["rate(life)"]
    assert "lifetime zero" in zero["refused"]
