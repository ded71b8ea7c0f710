"""Additions from outside: one entry in a table, and every reader of the table shows it."""

import json

import numpy as np
import pytest

import uq as api
from uq.analysis.statistics.statistic import Statistic
from uq.analysis.statistics.table import STATISTICS
from uq.estimate import Estimate


def _geometric_mean(element, context):
    """Yield exp(mean(log)) of an output whose values are all positive."""
    if (element.at_least > 0).all():
        logarithms = np.log(element.at_least)
        reach = 1.96 * logarithms.std() / np.sqrt(len(logarithms))
        value = logarithms.mean()
        found = Estimate(*np.exp([value, value - reach, value + reach]).tolist())
        yield Statistic(("geometric_mean",), "geometric mean", found, element.units)


def test_a_statistic_is_one_entry_of_a_table(uq, write_study, monkeypatch):
    monkeypatch.setitem(STATISTICS, "geometric_mean", _geometric_mean)
    for name, seed in (("one", 1), ("other", 2)):
        assert uq("run", write_study("linear", seed=seed), "-o", f"{name}.nc").code == 0

    entry = json.loads(uq("summary", "one.nc", "--json").out)["outputs"]["y"]["geometric_mean"]
    assert entry["low"] < entry["value"] < entry["high"]
    (line,) = (x for x in uq("summary", "one.nc").out.splitlines() if "geometric mean" in x)
    assert f"{entry['value']:.5g}" in line and f"{entry['low']:.5g}" in line
    table = api.summary(api.open_result("one.nc"))
    assert table.loc["y", "geometric mean"] == pytest.approx(entry["value"])
    assert table.loc["y", "geometric mean_high"] == pytest.approx(entry["high"])

    compared = json.loads(uq("compare", "one.nc", "other.nc", "--json").out)
    pair = compared["outputs"]["y"]["geometric_mean"]
    assert pair["a"] == entry
    apart = pair["difference"]
    assert apart["low"] < apart["value"] == pytest.approx(pair["b"]["value"] - entry["value"])
    assert "geometric mean" in uq("compare", "one.nc", "other.nc").out

    assert uq("report", "one.nc", "-o", "one.html").code == 0
    with open("one.html", encoding="utf-8") as page:
        assert f">{entry['value']:.5g}<" in page.read()
