"""Screening designs and what reads their results: holes and borders refused, nothing zeroed."""

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import (
    as_text,
    asking,
    linear,
    study_of,
    summarised,
    with_output,
    with_status,
)
from screened import index_entry

from uq.assess.sensitivity_table import sensitivity
from uq.assess.summary_table import summary
from uq.errors import InputError
from uq.indices.methods import METHODS, fed_by
from uq.sampling.designs import DESIGNS


def values_of(entry):
    return {
        (kind, name): estimate["value"]
        for kind, table in entry.items()
        if isinstance(table, dict)
        for name, estimate in table.items()
    }


@pytest.mark.parametrize("method", ["morris", "fast"])
@pytest.mark.parametrize("value", [1.0, np.nan, np.inf])
def test_an_output_without_variance_is_refused_not_zero(method, value):
    ds = linear(method, 80, 2)
    ds = with_output(ds, "flat", np.full(ds.sizes["row"], value))
    entry = index_entry(asking(ds, outputs=["flat"]), "flat")
    assert entry["refused"] and not {"S1", "ST", "mu_star"} & entry.keys()


def test_missing_rows_are_refused():
    for method in ("morris", "fast"):
        ds = linear(method, 80, 2)
        with pytest.raises(InputError, match="rows of the design are missing"):
            sensitivities(ds.isel(row=slice(1, None)))
        shuffled = ds.isel(row=np.random.default_rng(1).permutation(ds.sizes["row"]))
        assert values_of(index_entry(shuffled)) == pytest.approx(
            values_of(index_entry(ds)), abs=1e-9
        )


# The border to SALib: what is lacking never reaches it, and no seed is taken for none.

# One design for each method, the last that feeds it; 'regional' takes regimes, not numbers.
_LAST = {
    method: name
    for name, declared in DESIGNS.items()
    if declared.draw
    for method in fed_by(declared)
}
FED = [
    pytest.param(design, method, marks=[pytest.mark.slow] * (method == "hdmr"))
    for method, design in _LAST.items()
    if METHODS[method].takes_numbers
]


def samples_of(design):
    """Return how many: trajectories that lie far apart take long to choose."""
    return 32 if design == "morris-optimised" else 256


@pytest.mark.parametrize(("design", "method"), FED)
def test_one_lacking_value_changes_little_and_zeroes_nothing(design, method):
    ds = linear(design, samples_of(design), 4)
    full = index_entry(ds, method=method)
    assert "refused" not in full
    y = ds["y"].values.copy()
    y[5] = np.nan
    hurt = with_status(with_output(ds, "z", y), [5], 2)
    hurt = sensitivities(asking(hurt, outputs=["z"]), method)
    assert hurt["groups_dropped"] == 1
    for kind, values in full.items():
        if isinstance(values, dict) and kind not in ("dummy", "sigma"):
            for name, estimate in values.items():
                value = hurt["outputs"]["z"][kind][name]["value"]
                assert value == pytest.approx(estimate["value"], abs=0.05)
            if kind != "S2":  # a linear function has no interactions
                assert max(abs(estimate["value"]) for estimate in values.values()) > 0.1


@pytest.mark.parametrize(("design", "method"), FED)
def test_seed_zero_is_a_seed(design, method):
    n = samples_of(design)
    once, again, other = (
        index_entry(linear(design, n, 4, seed=s), method=method) for s in (0, 0, 1)
    )
    assert once == again and "refused" not in once
    if design not in ("morris", "morris-optimised"):  # which know a linear function exactly
        assert once != other


# What else reads a result


def test_there_are_no_statistics_of_trajectories_and_it_is_said():
    ds = linear("morris", 8, 4)
    statistics = summarised(ds)
    assert (statistics["samples"], statistics["rows_used"]) == (160, 0)
    assert statistics["outputs"]["y"]["mean"] is None
    assert statistics["outputs"]["y"]["quantiles"]["0.5"]["value"] is None
    assert statistics["notes"] == [
        "no statistics: the rows of a 'morris' design do not follow the laws of the inputs;"
        " see 'uq sensitivity'"
    ]
    assert np.isnan(summary(ds)["mean"].item())


def test_curves_are_as_good_as_any_rows_for_statistics():
    statistics = summarised(linear("fast", 257, 8))
    assert statistics["rows_used"] == 257 * 8 * 4
    assert statistics["outputs"]["y"]["mean"] == pytest.approx(5, abs=0.05)


def test_measures_stand_in_arrays_tables_and_figures(uq, write_study, folder):
    arrays = sensitivity(linear("morris", 8, 4))
    assert arrays["mu_star"].sel(parameter="x3").item() == pytest.approx(3)
    path = write_study("ishigami", "morris", 8, 4, name="screening")
    assert uq("run", path, "--workers", 0).code == 0
    shown = uq("sensitivity", "results/screening.nc").out
    assert "mu_star" in shown and "sigma" in shown
    drawn = uq("plot", "results/screening.nc").out.split()
    assert [name.rpartition("/")[2] for name in drawn] == ["morris-y.png"]


def test_the_template_names_the_designs(uq):
    text = uq("init", "ishigami").out
    for name in DESIGNS:
        assert f"# {name}: " in text


def test_a_wrong_method_is_refused_with_the_designs_that_can(uq):
    ds = linear("monte-carlo", 128)
    with pytest.raises(InputError, match="'morris' needs a design of morris or morris-optimised"):
        sensitivities(ds, "morris")
    tables = {
        "study": {"name": "a", "model": "linear"},
        "design": {"method": "saltelli", "samples": 64},
        "uncertain": {"x1": {"distribution": "uniform", "lower": 0.0, "upper": 1.0}},
        "analysis": {"sensitivity": ["fast"]},
    }
    with pytest.raises(InputError) as caught:
        study_of(tables)
    assert "a 'saltelli' design cannot feed it, method = 'fast' can" in str(caught.value)
    assert as_text(tables)
