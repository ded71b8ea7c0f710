"""Regimes as a level decides them: a repeat may end in another."""

import numpy as np
import pytest
from nested_studies import nested_result, regimes

import uq as api
from uq.assess.components_by_level import by_level
from uq.result.nesting import nesting_of
from uq.result.result import Result


def test_a_repeat_may_end_in_another_regime():
    ds = nested_result(samples=200, units=3, repeats=4)
    chance = ds["x3"].values
    level_shares = by_level(Result(regimes(ds, chance > 0.25)))
    mean = level_shares.another_regime
    assert mean.low < 2 * 0.25 * 0.75 < mean.high
    each = nesting_of(ds).table(level_shares.switching)
    codes = nesting_of(ds).table(chance > 0.25)
    unit = codes[0, 0]
    others = [np.mean(np.delete(unit, i) != unit[i]) for i in range(4)]
    assert each[0, 0] == pytest.approx(others)
    calm = by_level(Result(regimes(ds, ds["x2"].values > 0.5))).another_regime
    assert calm.value == calm.low == 0 and 0 < calm.high < 0.03  # 200 samples, not 2400 rows
    lost = by_level(Result(regimes(ds, np.full(len(chance), -1)))).another_regime
    assert "one repeat per unit" in lost.reason


def test_no_repeat_ends_in_another_regime_where_nothing_is_random():
    ds = nested_result(levels={"x1": "shared", "x2": "own"}, samples=20, repeats=1)
    level_shares = by_level(Result(regimes(ds, ds["x2"].values > 0.5)))
    assert level_shares.another_regime.numbers == (0.0, 0.0, 0.0)
    single = nested_result(samples=20, repeats=1)
    assert (
        "set repeats = 2"
        in by_level(Result(regimes(single, single["x2"].values > 0.5))).another_regime.reason
    )


def test_a_regime_has_shares_like_any_event(uq, tmp_path):
    ds = nested_result(samples=400, units=1, repeats=2)
    calm = regimes(ds, ds["x2"].values > 0.5)
    outputs = by_level(Result(calm), "regime").outputs
    assert list(outputs) == ["P(regime=calm)", "P(regime=wild)"]
    for shares in outputs.values():
        assert shares.shares["chance"].value == pytest.approx(0.0, abs=1e-12)
    moody = by_level(Result(regimes(ds, ds["x3"].values > 0.5)), "regime").outputs["P(regime=wild)"]
    assert moody.shares["chance"].low < 1.0 <= moody.shares["chance"].high
    rare = by_level(Result(regimes(ds, ds["x3"].values > 0.997)), "regime").outputs[
        "P(regime=wild)"
    ]
    assert "are needed for an index" in rare.shares["chance"].reason
    traced = api.trace(calm, "levels/outputs/P(regime=calm)/own")
    assert traced["equal"]
