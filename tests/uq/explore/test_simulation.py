"""One row of a model, by name and with everything it says about itself."""

from math import inf

import numpy as np
import pytest
import sample_models
import xarray as xr

import uq
from uq.errors import InputError
from uq.files import whole_files


def test_one_row_at_the_nominal_values_but_for_what_is_set():
    ds = uq.simulate("linear", {"x2": 1.0})
    assert ds["y"].dims == ("row",)
    assert ds["y"].values == [0.5 + 2.0 + 1.5 + 2.0]
    assert [ds[name].item() for name in ("x1", "x2", "x3", "x4")] == [0.5, 1.0, 0.5, 0.5]
    assert ds["x2"].attrs["role"] == "fixed"
    assert ds["y"].attrs["long_name"] == "value of the function"
    assert ds.attrs["source"] == "linear 1"
    assert "trajectory" not in ds
    assert all("role" in variable.attrs for variable in ds.data_vars.values())


def test_the_trajectory_is_labelled():
    ds = uq.simulate(sample_models.KINDS, {"x1": 0.5})
    assert ds["trajectory"].dims == ("time", "quantity")
    place = ds["trajectory"].sel(quantity="x")
    assert np.array_equal(place, 0.5 * ds["time"].values)
    assert (place["units"], place["meaning"]) == ("m", "place")
    assert ds["time"].attrs["units"] == "s"
    assert "trajectory" not in uq.simulate(sample_models.KINDS, trajectory=False)


def test_the_seed_reaches_the_model():
    works = [uq.simulate(sample_models.KINDS, seed=seed)["work"].values[0, 1] for seed in (0, 3)]
    assert works[1] - works[0] == pytest.approx(3e-3)


def test_a_setting_is_used_and_a_failure_reported():
    ds = uq.simulate("linear", {"x1": 0.9}, {"fail_above": 0.5, "fail_how": "raise"})
    assert ds["status"].values == [3]
    assert ds["status"].attrs["example_raised"] == "ValueError: x1 is above fail_above = 0.5"


def test_all_mistakes_are_reported_at_once():
    with pytest.raises(InputError) as refused:
        uq.simulate("linear", {"x1": 2.0, "y1": 1.0}, {"fail_abov": 1.0, "fail_how": "slowly"})
    assert len(refused.value.lines) == 4
    for line, words in zip(
        refused.value.lines,
        ["x1 = 2.0: must", "y1 = 1.0: no such parameter", "'fail_above'", "one of nan, inf"],
        strict=True,
    ):
        assert words in line


@pytest.mark.parametrize(("given", "sag"), [({}, 0.0), ({"mount_stiffness": 1e4}, 2 * 9.81e-4)])
def test_a_rigid_part_is_computed_and_kept_in_a_file(folder, given, sag):
    ds = uq.simulate(sample_models.MOUNTED, given)
    assert ds["sag"].values == [sag]
    whole_files.write(ds, folder / "row.nc")
    with xr.open_dataset("row.nc") as kept:
        assert kept["mount_stiffness"].item() == given.get("mount_stiffness", inf)
        assert kept["mount_stiffness"].attrs["role"] == "fixed"


def test_an_unknown_model_is_refused():
    with pytest.raises(InputError, match="no such model 'liner'; did you mean 'linear'"):
        uq.simulate("liner")
