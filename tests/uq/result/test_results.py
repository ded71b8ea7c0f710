"""The schema of a result, as a reader finds it."""

import hashlib
import platform
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from computed import computed, linear, study_of
from in_memory import compute

import uq
from uq.assess.summary import summarise
from uq.assess.summary_facts import summary_facts
from uq.contract import Status
from uq.errors import InputError
from uq.execution import runner
from uq.explore.single_rows import simulate
from uq.files import whole_files
from uq.files.netcdf_files import CHECKSUM
from uq.render.html.dossier.chapters import dossier
from uq.render.html.page import page
from uq.result import result_file
from uq.result.elements import elements_of
from uq.result.result import Result
from uq.result.variables import outputs_of
from uq.study.definition import load_study, study_from_text


@pytest.fixture
def kinds(write_study):
    """Return a small saltelli result with one output of every kind, read back from its file."""
    path = write_study(
        model="kinds",
        method="saltelli",
        samples=8,
        replicates=2,
        uncertain=("x2",),
        law='distribution = "uniform", lower = 0.0, upper = 1.0, source = "a guess"',
        more="[fixed]\nx1 = 0.125",
    )
    study = load_study(path, "sample_models:KINDS")
    runner.run(study, "kinds.nc", workers=0)
    return study, "kinds.nc"


def test_a_result_opens_with_plain_xarray_and_describes_itself(kinds):
    study, path = kinds
    with xr.open_dataset(path) as ds:
        assert ds.sizes == {"row": 48, "side": 2, "depth": 2}
        assert list(ds["side"].values) == ["left", "right"]
        assert list(ds["depth"].values) == [0.5, 1.5]
        assert ds["x2"].dims == ("row",)
        attrs = dict(ds["x2"].attrs)
        attrs["admissible"] = list(attrs["admissible"])
        assert attrs == {
            "role": "input",
            "units": "s",
            "long_name": "second input",
            "symbol": "x_2",
            "source": "a guess",
            "nominal": 0.5,
            "admissible": [0.0, 1.0],
        }
        assert ds["x1"].dims == ()
        assert ds["x1"].item() == 0.125
        assert ds["x1"].attrs["role"] == "fixed"
        assert ds["x1"].attrs["source"] == "made up"
        assert ds["life"].dims == ("row", "side", "depth")
        assert ds["life"].attrs == {
            "role": "output",
            "kind": "lifetime",
            "units": "s",
            "long_name": "time to a depth",
            "may_be_undefined": 0,
            "never_known_at_once": 1,
        }
        assert ds["life_censored"].dtype == np.int8
        assert ds["life_censored"].attrs["role"] == "censored"
        assert ds["angle"].attrs["may_be_undefined"] == 1
        assert ds.attrs["title"] == "small"
        assert ds.attrs["source"] == "kinds 1"
        assert ds.attrs["study"] == study.text
        assert ds.attrs["study_sha256"] == hashlib.sha256(study.text.encode()).hexdigest()
        assert ds.attrs["study_identity"] == study.identity
        assert ds.attrs["python"] == platform.python_version()
        assert ds.attrs["numpy"] == np.__version__
        assert ds.attrs["cpu"]
        facts = ("design", "samples", "replicates", "second_order", "seed", "schema_version")
        assert [ds.attrs[name] for name in facts] == ["saltelli", 8, 2, 0, 5, 2]


def test_flags_are_integers_without_fill_value(kinds):
    _, path = kinds
    with netCDF4.Dataset(path) as file:
        assert file.data_model == "NETCDF4"
        for variable in file.variables.values():
            assert "_FillValue" not in variable.ncattrs()
        for name, meanings in {
            "status": [status.label for status in Status],
            "regime": ["none", "slow", "fast"],
            "block": ["A", "AB_x2", "B"],
        }.items():
            variable = file[name]
            assert variable.flag_meanings.split() == meanings
            assert variable.flag_values.dtype == variable.dtype
            assert set(variable[:]) <= set(variable.flag_values)
        assert list(file["regime"].flag_values) == [-1, 0, 1]


def test_rows_know_their_place_in_the_design(kinds):
    _, path = kinds
    ds = result_file.open_result(path)
    row = np.arange(48)
    assert np.array_equal(ds["row"], row)
    assert np.array_equal(ds["block"], row % 3)
    assert np.array_equal(ds["replicate"], row // 3 % 2)
    assert np.array_equal(ds["group"], row // 6)
    assert set(ds.coords) >= {"replicate", "group", "block"}
    a, ab, b = (ds["x2"].values[ds["block"] == block] for block in range(3))
    assert np.array_equal(ab, b)
    assert not np.array_equal(a, b)


def test_an_example_stands_beside_each_failing_status(write_study):
    path = write_study(
        model="linear",
        uncertain=("x1", "x2"),
        more='[settings]\nfail_above = 0.5\nfail_how = "raise"',
    )
    ds = compute(load_study(path), workers=0, chunk_rows=7)
    first = int(np.flatnonzero(ds["x1"] > 0.5)[0])
    assert ds["status"].attrs["example_raised"] == (
        f"row {first}: ValueError: x1 is above fail_above = 0.5"
    )
    assert np.array_equal(ds["status"] == Status.RAISED, ds["x1"] > 0.5)


@pytest.mark.parametrize("more", ["", "[fixed]\nmount_stiffness = inf"])
def test_a_fixed_parameter_may_be_infinite(write_study, more):
    law = 'distribution = "uniform", lower = 1.0, upper = 2.0'
    path = write_study(model="mounted", uncertain=("mass",), law=law, more=more)
    study = load_study(path, "sample_models:MOUNTED")
    runner.run(study, "mounted.nc", workers=0)
    ds = result_file.open_result("mounted.nc")
    assert ds["mount_stiffness"].item() == np.inf
    assert ds["mount_stiffness"].attrs["role"] == "fixed"
    assert not ds["sag"].any()
    assert runner.finished(study, Path("mounted.nc")).identical(ds)


def test_what_is_not_a_result_is_refused_in_a_sentence(folder, kinds):
    _, path = kinds
    (folder / "notes.txt").write_text("no netCDF at all")
    xr.Dataset({"a": 1}).to_netcdf("other.nc")
    whole_files.write(simulate("linear"), folder / "single.nc")
    result_file.open_result(path).assign_attrs(schema_version=99).to_netcdf("future.nc")
    result_file.open_result(path).assign_attrs(schema_version=0).to_netcdf("past.nc")
    for name, words in {
        "missing.nc": "no such file",
        ".": "is a folder",
        "notes.txt": "not a readable netCDF file",
        "other.nc": "not a result of 'uq run'",
        "single.nc": "not a result of 'uq run'",
        "future.nc": "written with schema version 99; this version of vibrolife reads 2",
        "past.nc": "written with schema version 0; this version of vibrolife reads 2",
    }.items():
        with pytest.raises(InputError) as refused:
            result_file.open_result(name)
        assert refused.value.lines[0].startswith(f"{name}: {words}")
        assert len(refused.value.lines) == 1


def test_elements_are_named_by_their_coordinates(kinds):
    _, path = kinds
    ds = result_file.open_result(path)
    named = {element.name: element.values for element in elements_of(ds, ["life", "angle"])}
    assert list(named)[:-1] == [
        f"life[side={side},depth={depth}]" for side in ("left", "right") for depth in (0.5, 1.5)
    ]
    assert np.array_equal(named["life[side=right,depth=0.5]"], ds["life"].values[:, 1, 0])
    assert list(named)[-1] == "angle"


def test_a_row_out_of_budget_failed_only_where_an_output_is_lacking(kinds):
    _, path = kinds
    ds = result_file.open_result(path)
    assert not result_file.failed(ds).any()
    ds["status"].values[:4] = Status.OUT_OF_BUDGET
    ds["status"].values[4] = Status.RAISED
    ds["work"].values[0, 1] = np.nan
    ds["regime"].values[1] = -1
    ds["angle"].values[2] = np.nan
    ds["life"].values[3] = np.inf  # it never ends
    assert list(np.flatnonzero(result_file.failed(ds))) == [0, 1, 4]
    ds["work"].values[3] = np.inf
    assert list(np.flatnonzero(result_file.failed(ds))) == [0, 1, 3, 4]


def test_new_text_of_the_same_study_replaces_the_old(kinds, write_study):
    study, path = kinds
    renamed = load_study(
        write_study(
            model="kinds",
            method="saltelli",
            samples=8,
            replicates=2,
            uncertain=("x2",),
            law='distribution = "uniform", lower = 0.0, upper = 1.0, source = "a test"',
            more="[fixed]\nx1 = 0.125\n[analysis]\nquantiles = [0.1]",
        ),
        "sample_models:KINDS",
    )
    assert renamed.identity == study.identity
    ds = runner.run(renamed, path)
    assert ds.attrs["study"] == renamed.text
    assert ds["x2"].attrs["source"] == "a test"
    assert result_file.open_result(path).identical(ds)


def test_a_file_holds_what_memory_holds(kinds):
    study, path = kinds
    ds = compute(study, workers=0)
    assert result_file.open_result(path).identical(ds)
    # Merged from chunks or written at once: the layout may differ, nothing that is said does.
    whole_files.write_result(ds, Path("again.nc"))
    with netCDF4.Dataset(path) as merged, netCDF4.Dataset("again.nc") as again:
        assert merged.getncattr(CHECKSUM) == again.getncattr(CHECKSUM)


def test_what_is_read_of_a_large_result_is_not_kept_in_memory(kinds, monkeypatch):
    _, path = kinds
    small = result_file.open_result(path)
    monkeypatch.setattr(result_file, "_IN_MEMORY_BYTES", 0)
    with result_file.open_result(path) as large:
        assert (
            summary_facts(summarise(Result(large))).json
            == summary_facts(summarise(Result(small))).json
        )
        assert large.identical(small)
        assert not any(large[name].variable._in_memory for name in large.data_vars if name != "x1")


def test_a_new_text_of_a_study_does_not_say_that_rows_were_computed_here():
    ds = linear(samples=4).assign_attrs(cpu="another processor", numpy="0.9")
    study = study_from_text(ds.attrs["study"] + "\n# a comment\n")
    attrs = result_file.relabel(ds, study).attrs
    assert attrs["study"].endswith("# a comment\n")
    assert (attrs["cpu"], attrs["numpy"]) == ("another processor", "0.9")


@pytest.mark.parametrize("described", [{}, {"description": "What lasts"}])
def test_a_result_is_titled_by_what_its_study_says_it_is(described):
    tables = {
        "study": {"name": "plain", "model": "linear"} | described,
        "design": {"method": "monte-carlo", "samples": 8},
        "uncertain": {"x1": {"distribution": "uniform", "lower": 0.0, "upper": 1.0}},
    }
    assert computed(study_of(tables)).attrs["title"] == described.get("description", "plain")


@pytest.mark.parametrize(
    "ask",
    [
        uq.summary,
        uq.answer,
        uq.sensitivity,
        lambda ds: uq.row(ds, 0),
        lambda ds: uq.trace(ds, "outputs/y/mean"),
        lambda ds: page(Result(ds), "none.nc"),
        lambda ds: dossier(Result(ds), "none.nc"),
    ],
)
def test_a_result_of_which_no_row_was_kept_is_refused_in_one_line(ask):
    ds = linear("monte-carlo", samples=8).isel(row=slice(0))
    with pytest.raises(InputError) as refused:
        ask(ds)
    assert str(refused.value) == "this result has no rows"


def test_an_output_with_numerical_errors_names_the_setting_that_reduces_them():
    x = {"distribution": "uniform", "lower": 2e-4, "upper": 3e-4}
    tables = {
        "study": {"name": "rods", "model": "beam"},
        "design": {"method": "monte-carlo", "samples": 1},
        "uncertain": {"initial_gap": x},
        "settings": {"depths": [1e-6], "accuracy": 1.0},
        "analysis": {"outputs": ["first_time_to_depth"]},
    }
    result = Result(computed(study_of(tables)))
    assert result.outputs["first_time_to_depth"].accuracy == "accuracy"


def test_the_outputs_of_a_result_are_read_without_a_data_array(kinds, monkeypatch):
    ds = result_file.open_result(kinds[1])
    expected = outputs_of(ds)

    def slow(*_):
        raise AssertionError("a DataArray takes a hundred times as long as a variable")

    monkeypatch.setattr(xr.Dataset, "__getitem__", slow)
    assert outputs_of(ds) == expected
