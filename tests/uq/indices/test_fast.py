"""Extended FAST and random balance designs: known answers, and those of SALib."""

from math import pi

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import (
    asking,
    computed,
    linear,
    with_output,
    with_status,
)
from SALib.analyze import fast as salib_fast
from screened import A, g_function, index_entry, ishigami


def test_a_failed_row_takes_its_curve_along():
    ds = linear("fast", 129, 4)
    full = index_entry(ds)
    y = ds["y"].values.copy()
    y[0] = np.nan
    hurt = with_status(with_output(ds, "z", y), [0], 2)
    indices = sensitivities(asking(hurt, outputs=["z"]))
    assert (indices["groups_dropped"], indices["rows_used"]) == (1, 15 * 129)
    for kind in ("S1", "ST"):
        for name, estimate in indices["outputs"]["z"][kind].items():
            assert estimate["value"] == pytest.approx(full[kind][name]["value"], abs=0.02)
    y[ds["block"].values == 0] = np.nan
    gone = index_entry(asking(with_output(ds, "z", y), outputs=["z"]), "z")
    assert gone["refused"] == "none of 4 curves for x1 has a value in each row"


V1, V2, V13 = 0.5 * (1 + pi**4 / 50) ** 2, 49 / 8, pi**8 * 8 / 22500
ISHIGAMI = {
    "S1": np.array([V1, V2, 0.0]) / (V1 + V2 + V13),
    "ST": np.array([V1 + V13, V2, V13]) / (V1 + V2 + V13),
}
PARTS = 1 / (3 * (1 + A) ** 2)
G_FUNCTION = {
    "S1": PARTS / (np.prod(1 + PARTS) - 1),
    "ST": PARTS * np.prod(1 + PARTS) / (1 + PARTS) / (np.prod(1 + PARTS) - 1),
}


@pytest.mark.parametrize(
    ("study", "exact"),
    [(ishigami("fast", 1025, 2), ISHIGAMI), (g_function("fast", 1025, 2), G_FUNCTION)],
    ids=["ishigami", "g-function"],
)
def test_extended_fast_comes_close_and_claims_no_interval(study, exact):
    entry = index_entry(computed(study))
    for kind, values in exact.items():
        for estimate, value in zip(entry[kind].values(), values, strict=True):
            assert estimate["value"] == pytest.approx(value, abs=0.05)  # ST of x2 is 0.045 off
            assert estimate["low"] is None and estimate["high"] is None
    assert entry["notes"][0].startswith("no intervals: the method's own error")


def test_extended_fast_is_that_of_salib():
    ds = computed(ishigami("fast", 200, 1))
    order = np.lexsort([ds["group"], ds["block"]])
    problem = {"num_vars": 3, "names": ["x1", "x2", "x3"]}
    with pytest.warns(UserWarning, match="FAST confidence intervals"):
        theirs = salib_fast.analyze(problem, ds["y"].values[order], num_resamples=2)
    for kind in ("S1", "ST"):
        ours = [estimate["value"] for estimate in index_entry(ds)[kind].values()]
        np.testing.assert_allclose(ours, theirs[kind], rtol=1e-9, atol=1e-12)


def test_too_few_points_for_the_inputs_are_refused():
    (_, note) = index_entry(computed(g_function("fast", 129)))["notes"]
    assert note == "7 inputs share 2 frequencies; samples = 449 would give each its own"
    assert len(index_entry(computed(g_function("fast", 449)))["notes"]) == 1


@pytest.mark.parametrize("study", [ishigami, g_function])
def test_a_random_balance_design_feeds_rbd_fast(study):
    exact = ISHIGAMI if study is ishigami else G_FUNCTION
    entry = index_entry(computed(study("rbd-fast", 2048, 1)))
    for estimate, value in zip(entry["S1"].values(), exact["S1"], strict=True):
        assert estimate["value"] == pytest.approx(value, abs=0.06)
    assert 0 < entry["dummy"]["S1"] < 0.1
