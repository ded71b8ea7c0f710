"""What no run leaves behind is refused when a result is opened, not computed with."""

import json

import netCDF4
import numpy as np
import pytest
import xarray as xr
from learnt_studies import measured, wear

from uq.errors import InputError
from uq.execution import runner
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.learning.posterior_result import as_unit, inspections_of
from uq.result.result import Result
from uq.result.result_file import open_result
from uq.result.soundness import unsound


@pytest.fixture(scope="module")
def rows():
    return wear(samples=40)


@pytest.fixture(scope="module")
def posterior():
    return update(wear(rate="shared", samples=400, units=2), measured(6e5, 7e5))


def with_value(ds, name, value, row=3):
    values = np.array(ds[name].values)
    values[row] = value
    return ds.assign({name: ds[name].copy(data=values)})


def with_attribute(ds, name, **attrs):
    return ds.assign({name: ds[name].assign_attrs(attrs)})


IMPOSSIBLE = {
    "a negative life": (lambda ds: with_value(ds, "life", -1.0), "a life cannot be negative"),
    "no life": (lambda ds: with_value(ds, "life", np.nan), "'life' is nan, in a valid row"),
    "no input": (lambda ds: with_value(ds, "rate", np.nan), "'rate' is not within"),
    "an input beyond its bounds": (lambda ds: with_value(ds, "rate", -1e-9), "'rate' is not"),
    "an infinite input": (lambda ds: with_value(ds, "rate", np.inf), "'rate' is not within"),
    "rows at one place": (lambda ds: with_value(ds, "group", 0), "several rows have one place"),
    "more samples than rows": (lambda ds: ds.assign_attrs(samples=2**40), "40 rows are fewer"),
    "no fixed value": (lambda ds: ds.assign(threshold=ds["threshold"] * np.nan), "not a number"),
    "a model of numbers": (lambda ds: ds.assign_attrs(model=np.zeros(2)), "'model' is not text"),
    "code of numbers": (lambda ds: ds.assign_attrs(code=np.zeros(2)), "'code' is not text"),
    "a role of numbers": (
        lambda ds: with_attribute(ds, "threshold", role=np.zeros(2)),
        "attribute 'role' of 'threshold' is not text",
    ),
    "a kind of numbers": (
        lambda ds: with_attribute(ds, "life", kind=np.zeros(2)),
        "attribute 'kind' of 'life' is not text",
    ),
    "a seed of text": (lambda ds: ds.assign_attrs(seed="1"), "'seed' is not a number"),
    "an escape in a name": (lambda ds: ds.assign({"\x1b[2J": 1.0}), "control characters"),
    "an output that is asked for": (
        lambda ds: with_attribute(ds, "life", role="kept"),
        "its study asks for 'life', which it does not contain",
    ),
    "a rerun with code": (
        lambda ds: ds.assign(
            rerun=ds["status"].assign_attrs(role="rerun", changed_0="{a = __import__('os')}")
        ),
        "'changed_0' of 'rerun' is not a table",
    ),
}


@pytest.mark.parametrize("kind", IMPOSSIBLE)
def test_what_no_run_leaves_behind_is_unsound(rows, kind):
    change, words = IMPOSSIBLE[kind]
    assert unsound(rows) == ""
    assert words in unsound(change(rows))


def test_a_failed_row_may_lack_its_outputs(rows):
    failed = with_value(with_value(rows, "life", np.nan), "status", 2)
    assert unsound(failed) == ""


WEIGHTS = {
    "weights without a sum": (lambda ds: with_value(ds, "weight", 1e200), "'weight' is negative"),
    "weights of a unit": (lambda ds: with_value(ds, "unit_weight", np.nan, (0, 0)), "unit_weight"),
    "one weight for all": (
        lambda ds: ds.assign(unit_weight=("inspected", np.ones(2), ds["weight"].attrs)),
        "'unit_weight' is not of the dimensions inspected, row",
    ),
    "inspections of numbers": (
        lambda ds: ds.assign_attrs(inspections=np.zeros(2)),
        "'inspections' is not a list",
    ),
    "inspections that are none": (
        lambda ds: ds.assign_attrs(inspections="[1]"),
        "'inspections' is not a list",
    ),
    "an unknown input": (
        lambda ds: ds.assign_attrs(integrated_input="nothing"),
        "'integrated_input' names no input",
    ),
    "a model error of text": (lambda ds: ds.assign_attrs(model_error="x"), "'model_error' is not"),
    "units without names": (
        lambda ds: ds.assign_coords(inspected=[1.0, 2.0]),
        "'inspected' does not name",
    ),
    "no scales": (lambda ds: ds.drop_vars("unit_scale"), "'unit_scale'"),
    "no largest weight": (lambda ds: ds.drop_vars("unit_largest_weight"), "unit_largest_weight"),
    "an odd largest weight": (
        lambda ds: with_attribute(ds, "weight", largest_possible="x"),
        "'largest_possible' of 'weight'",
    ),
    "a negative life before": (
        lambda ds: with_value(ds, "prior_life", -1.0),
        "'prior_life' is -1.0",
    ),
    "lives before, of another shape": (
        lambda ds: ds.assign(prior_life=((), 1.0, ds["prior_life"].attrs)),
        "'prior_life' is not of the shape of 'life'",
    ),
}


@pytest.mark.parametrize("kind", WEIGHTS)
def test_what_no_inspections_leave_behind_is_unsound(posterior, kind):
    change, words = WEIGHTS[kind]
    assert unsound(posterior) == ""
    assert words in unsound(change(posterior))


def test_wrong_inspections_in_a_result_are_one_line(posterior):
    entries = json.dumps([{"unit": "A", "hours": 3.0}, {"unit": 5}])
    with pytest.raises(InputError, match=r"inspection 1: .*; and \d+ more") as refused:
        inspections_of(Result(posterior.assign_attrs(inspections=entries)))
    assert len(refused.value.lines) == 1


def test_posteriors_and_their_units_are_sound(posterior, tmp_path):
    for ds in (posterior, as_unit(posterior, "A")):
        write_result(ds, tmp_path / "post.nc")
        assert open_result(tmp_path / "post.nc").sizes["row"] == 800


@pytest.fixture
def result(write_study, folder):
    runner.run(write_study(samples=16), "out.nc", workers=0)
    return folder / "out.nc"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda ds: ds.drop_vars("y"), "does not contain the output 'y'"),
        (lambda ds: with_value(ds, "row", 10**12, -1), "does not number all rows"),
    ],
)
def test_an_incomplete_result_is_not_extended(uq, result, change, words):
    with xr.open_dataset(result) as opened:
        ds = opened.load()
    change(ds).to_netcdf(result)
    ended = uq("extend", result, "--samples", 32, "--workers", 0)
    assert (ended.code, ended.out) == (2, "")
    assert words in ended.err and ended.err.count("\n") == 1


def test_warnings_of_readers_do_not_reach_the_terminal(uq, result):
    with netCDF4.Dataset(result, "a") as file:
        file["y"].setncattr("_Unsigned", "true")
    assert "Warning" not in uq("summary", result).err


def test_a_version_of_several_numbers_is_refused(rows, tmp_path):
    write_result(rows.assign_attrs(schema_version=np.ones(2)), tmp_path / "x.nc")
    with pytest.raises(InputError, match=r"schema version \[1\. 1\.\]"):
        open_result(tmp_path / "x.nc")


def test_a_failure_of_the_system_is_not_called_a_damaged_file(uq, result, monkeypatch):
    def fail(*arguments, **options):
        raise OSError(24, "Too many open files", "out.nc")

    monkeypatch.setattr("uq.files.netcdf_files.is_intact", fail)
    assert "has changed" not in uq("summary", result).err
    monkeypatch.setattr("uq.result.result_file.xr.open_dataset", fail)
    assert "out.nc: cannot be read: Too many open files;" in uq("summary", result).err


def test_a_variable_without_a_role_is_left_alone(uq, result):
    with netCDF4.Dataset(result, "a") as file:
        file.createVariable("more", "f8", ("row",))
    for verb in (("summary", result), ("compare", result, result), ("row", result, 3)):
        assert uq(*verb).code == 0


def test_too_large_a_computation_ends_in_one_line(uq, result, monkeypatch):
    def without_memory(*arguments, **options):
        raise MemoryError("Unable to allocate 7 TiB")

    monkeypatch.setattr("uq.result.result.open_result", without_memory)
    ended = uq("plot", result)
    assert (ended.code, ended.err) == (1, "uq: not enough memory: Unable to allocate 7 TiB\n")


def test_a_refused_result_names_its_file(rows, tmp_path):
    write_result(with_value(rows, "life", -1.0), tmp_path / "x.nc")
    with pytest.raises(InputError, match=r"x\.nc: not a sound result: 'life' is -1\.0"):
        open_result(tmp_path / "x.nc")
