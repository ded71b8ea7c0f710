"""The summary of a result as one table: infinity stands for never, NaN for what is not known."""

import numpy as np
from computed import asking, linear, summarised, with_output

import uq


def test_each_end_of_an_interval_is_infinite_on_its_own():
    values = np.r_[np.linspace(1, 2, 54), np.full(10, np.inf)]
    ds = with_output(linear(samples=64), "life", values, "lifetime")
    ds = asking(ds, outputs=["life"], quantiles=[0.5, 0.8, 0.88], thresholds={"life": [1.5]})
    line = uq.summary(ds).loc["life"]
    statistics = summarised(ds)["outputs"]["life"]
    for probability in ("0.5", "0.8", "0.88"):
        for end in ("low", "high"):
            expected = statistics["quantiles"][probability][end]
            cell = line[f"q{probability}_{end}"]
            assert cell == (np.inf if expected is None else expected)
    assert np.isfinite(line["q0.8"]) and np.isinf(line["q0.8_high"])
    assert np.isinf(line["q0.88"]) and np.isfinite(line["q0.88_low"])
    assert np.isnan(line["mean"]) and line["never"] == 10
    shares = statistics["thresholds"]["1.5"]
    assert line["P(>1.5)"] == shares["above"]["value"] > line["P(<1.5)"]
    assert line["P(<1.5)_high"] == shares["below"]["high"]
