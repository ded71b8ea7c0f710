"""Rows that a file gives, to the bit."""

import numpy as np
import pytest
import xarray as xr
from computed import as_text, computed
from input_studies import UNIFORM, refusal, tables

from uq.analysis.statistics import summarise
from uq.errors import InputError
from uq.indices.sensitivities import sensitivities
from uq.rows.sampling import row_block
from uq.study.definition import study_from_text


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
    found = row_block(study, 0, 100).x
    np.testing.assert_array_equal(found[:, [0, 1, 3]], x[:, [0, 1, 1]])
    np.testing.assert_array_equal(row_block(study, 30, 31).x, found[30:31])
    ds = computed(study)
    assert sensitivities(ds)["method"] == "delta"
    assert summarise(ds)["outputs"]["y"]["mean_interval"]["low"] is None
    again = study_from_text(ds.attrs["study"])
    assert again.identity == study.identity
    np.testing.assert_array_equal(row_block(again, 0, 100).x, found)
    with pytest.raises(InputError, match="--samples 101: the file has 100 rows for 'imported'"):
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
    ("given", "said"),
    [
        (imported(None), "[design] file: is missing: a CSV or netCDF file with the rows"),
        (imported("row.csv"), "did you mean 'rows.csv'?"),
        (imported(uncertain={"x3": UNIFORM}), "has no column 'x3'"),
        (imported(replicates=2), "[design] replicates = 2: must be 1 for 'imported'"),
        (imported(samples=101), "[design] samples = 101: the file has 100 rows"),
        (imported(uncertain={"x1": UNIFORM | {"times": "x2"}, "x2": UNIFORM}), "take it out"),
        (
            imported()
            | {
                "dependence": {"parameters": ["x1", "x2"]}
                | dict(rank_correlation=[[1.0, 0.5], [0.5, 1.0]])
            },
            "imported rows are as dependent as they are",
        ),
        (tables({"x1": UNIFORM}, design={"file": "rows.csv"}), "only for method = 'imported'"),
    ],
)
def test_what_cannot_be_imported_is_one_line(table, given, said):
    assert said in refusal(given, table[0])


def test_imported_values_must_lie_within_the_bounds(table):
    (table[0] / "rows.csv").write_text("x1,x2\n" + "0.5,0.5\n" * 50 + "1.5,0.5\n" * 50)
    said = refusal(imported(), table[0])
    assert "'x1' = 1.5 in row 51 is outside the parameter's bounds, 0.0 to 1.0 [1]" in said
