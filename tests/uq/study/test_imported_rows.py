"""Rows that a file gives, to the bit."""

import numpy as np
import pytest
import xarray as xr
from asked_indices import sensitivities
from computed import as_text, compared, computed, summarised, with_output
from input_studies import UNIFORM, refusal, tables

import uq
from uq.assess.convergence import running_estimates
from uq.assess.pairing import Pairing, pairing
from uq.assess.survival import survival
from uq.errors import InputError
from uq.result.result import Result
from uq.study.definition import study_from_text
from uq.study.row_sampling import row_block


@pytest.fixture
def table(tmp_path):
    """Return a folder with rows to import, as CSV and as netCDF."""
    x = np.random.default_rng(3).uniform(0.1, 0.9, (100, 2))
    lines = ["x2,x1", *(f"{a!r},{b!r}" for b, a in x.tolist())]
    (tmp_path / "rows.csv").write_text("\n".join(lines))
    xr.Dataset({"x1": ("n", x[:, 0]), "x2": ("n", x[:, 1])}).to_netcdf(tmp_path / "rows.nc")
    return tmp_path, x


def imported(file="rows.csv", uncertain=None, **more):
    entries = {"x1": UNIFORM, "x2": UNIFORM} if uncertain is None else uncertain
    design = {"file": file} if file else {}
    return tables(entries, "imported", 100, design=design | more)


@pytest.mark.parametrize("file", ["rows.csv", "rows.nc"])
def test_imported_rows_are_those_of_the_file_to_the_bit(table, file):
    folder, x = table
    text = as_text(imported(file, {"x1": UNIFORM, "x2": UNIFORM, "x4": {"equals": "x2"}}))
    study = study_from_text(text, folder=folder)
    drawn = row_block(study, 0, 100).x
    np.testing.assert_array_equal(drawn[:, [0, 1, 3]], x[:, [0, 1, 1]])
    np.testing.assert_array_equal(row_block(study, 30, 31).x, drawn[30:31])
    ds = computed(study)
    assert sensitivities(ds)["method"] == "delta"
    statistics = summarised(ds)
    assert statistics["outputs"]["y"]["mean_interval"]["low"] is None
    assert "how the imported rows were drawn is unknown" in statistics["notes"][0]
    assert not any("replicates" in note for note in statistics["notes"])
    again = study_from_text(ds.attrs["study"])
    assert again.identity == study.identity
    np.testing.assert_array_equal(row_block(again, 0, 100).x, drawn)
    with pytest.raises(InputError, match="samples = 101: the file has 100 rows for 'imported'"):
        study.with_samples(101)


def test_without_a_number_of_samples_all_rows_are_imported(table):
    given = imported()
    del given["design"]["samples"]
    study = study_from_text(as_text(given), folder=table[0])
    assert study.design.samples == 100
    assert study.identity == study_from_text(as_text(imported()), folder=table[0]).identity
    again = study_from_text(computed(study).attrs["study"])
    assert (again.design.samples, again.identity) == (100, study.identity)
    assert study.with_samples(30).design.samples == 30
    del (other := tables({"x1": UNIFORM}))["design"]["samples"]
    assert "[design] samples: is missing" in refusal(other, table[0])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (imported(None), "[design] file: is missing: a CSV or netCDF file with the rows"),
        (imported("row.csv"), "did you mean 'rows.csv'?"),
        (imported(uncertain={"x3": UNIFORM}), "has no column 'x3'"),
        (imported(replicates=2), "[design] replicates = 2: must be 1 for 'imported'"),
        (imported(samples=101), "[design] samples = 101: the file has 100 rows"),
        (imported(uncertain={"x1": UNIFORM | {"times": "x2"}, "x2": UNIFORM}), "leave it out"),
        (
            imported()
            | {
                "dependence": {"parameters": ["x1", "x2"]}
                | dict(rank_correlation=[[1.0, 0.5], [0.5, 1.0]])
            },
            "imported rows carry their own dependence",
        ),
        (tables({"x1": UNIFORM}, design={"file": "rows.csv"}), "only for method = 'imported'"),
        (
            tables({"x1": UNIFORM}, design={"independent": True}),
            "[design] independent = true: only for method = 'imported'",
        ),
        (
            imported() | {"analysis": {"tolerance": {"coverage": 0.9, "confidence": 0.9}}},
            "independent = true if they are",
        ),
        (
            imported(independent=True) | {"analysis": {"twin": {"fail_above": 2.0}}},
            "needs rows that can be drawn",
        ),
    ],
)
def test_what_cannot_be_imported_is_one_line(table, given, message):
    assert message in refusal(given, table[0])


def test_imported_values_must_lie_within_the_bounds(table):
    (table[0] / "rows.csv").write_text("x1,x2\n" + "0.5,0.5\n" * 50 + "1.5,0.5\n" * 50)
    message = refusal(imported(), table[0])
    assert "'x1' = 1.5 in row 51 is outside the parameter's bounds, 0.0 to 1.0 [1]" in message


EVERYTHING = {
    "tolerance": {"coverage": 0.9, "confidence": 0.9},
    "thresholds": {"y": 1.5},
    "quantiles": [0.5],
}


def result_of(folder, **design):
    text = as_text(imported(**design) | {"analysis": EVERYTHING})
    return computed(study_from_text(text, folder=folder))


def test_rows_stated_to_be_independent_feed_what_a_plain_sample_feeds(table):
    folder, _ = table
    ds = result_of(folder, independent=True)
    statistics = summarised(ds)
    plain = summarised(ds.assign_attrs(design="monte-carlo"))
    assert statistics == plain and statistics["notes"] == []
    y = statistics["outputs"]["y"]
    for entry in (y["mean_interval"], y["quantiles"]["0.5"]):
        assert entry["low"] < entry["high"]
    assert y["tolerance"]["lower"] < y["tolerance"]["upper"]
    running = running_estimates(ds)
    assert running["samples"].max() == 100 and running["low"].notna().any()


def test_independent_draws_of_the_laws_are_not_called_dependent(table):
    for design, notes in (({"independent": True}, 0), ({}, 1)):
        ds = computed(study_from_text(as_text(imported(**design)), folder=table[0]))
        remarks = sensitivities(ds, "pawn")["outputs"]["y"]["notes"]
        assert sum("may depend on each other" in note for note in remarks) == notes
        assert not any("inputs are dependent" in note for note in remarks)


def test_methods_for_independent_inputs_take_rows_stated_to_be_such(table):
    folder, _ = table
    ds = result_of(folder, independent=True)
    plain = ds.assign_attrs(design="monte-carlo")
    sensitivity_result = sensitivities(ds)
    assert (
        sensitivity_result == sensitivities(plain) and sensitivity_result["method"] == "first-order"
    )
    unsaid = computed(study_from_text(as_text(imported()), folder=folder))
    with pytest.raises(InputError, match="but imported inputs may depend on each other"):
        sensitivities(unsaid, "hdmr")
    asks = imported() | {"analysis": {"sensitivity": ["hdmr"]}}
    assert "independent = true in [design] states otherwise" in refusal(asks, folder)
    asks = imported(independent=True) | {"analysis": {"sensitivity": ["hdmr"]}}
    assert study_from_text(as_text(asks), folder=folder).analysis.sensitivity == ("hdmr",)


def test_a_life_of_independent_imported_rows_has_a_curve_and_fits(table):
    ds = result_of(table[0], independent=True)
    values = np.random.default_rng(0).weibull(2.0, 100)
    ds = with_output(ds, "life", values, "lifetime")
    assert survival(ds, "life")["low"].notnull().any()
    assert uq.life_fits(ds, "life", ["weibull"]).loc[("life", "weibull"), "B10"] > 0


def test_without_the_statement_the_remedy_is_named(table):
    (note,) = summarised(computed(study_from_text(as_text(imported()), folder=table[0])))["notes"]
    assert "independent = true" in note and "replicates" not in note


def test_the_statement_does_not_change_the_rows(table):
    stated, silent = (
        study_from_text(as_text(imported(**more)), folder=table[0])
        for more in ({"independent": True}, {})
    )
    assert stated.identity == silent.identity


def test_the_same_imported_rows_are_pairs_and_others_are_not(table):
    folder, x = table
    first = result_of(folder, independent=True)
    assert (
        pairing(Result(first), Result(result_of(folder, independent=True, seed=5)))
        is Pairing.ROWS_IMPORTED
    )
    comparison = compared(first, first)
    same = {"value": 0.0, "low": None, "high": None, "identical": True}
    assert (
        comparison["pairing"] == "rows" and comparison["outputs"]["y"]["sd"]["difference"] == same
    )
    lines = ["x2,x1", *(f"{a!r},{b!r}" for b, a in (1 - x).tolist())]
    (folder / "rows.csv").write_text("\n".join(lines))
    other = result_of(folder, independent=True, seed=5)
    assert pairing(Result(first), Result(other)) is Pairing.UNKNOWN_IMPORTED
    assert compared(first, other)["pairing"] == "unknown"
