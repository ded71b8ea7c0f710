"""Running estimates, and the other errors beside that of sampling."""

import json

import numpy as np
import pytest
import xarray as xr
from asked_indices import sensitivities
from computed import asking, kinds, linear, summarised, with_output

from uq.assess.convergence import enough, running_estimates
from uq.errors import InputError
from uq.files import whole_files


@pytest.mark.parametrize(
    ("method", "replicates"),
    [("monte-carlo", 1), ("monte-carlo", 2), ("sobol", 8), ("halton", 4), ("saltelli", 8)],
)
def test_the_estimates_of_some_samples_are_those_of_a_study_of_as_many(method, replicates):
    thresholds = {"thresholds": {"y": 6.0}}
    whole, half = (linear(method, samples, replicates, thresholds) for samples in (128, 64))
    table = running_estimates(whole)
    assert sorted(set(table["samples"])) == [16, 32, 64, 128]
    for ds in (whole, half):
        entry = summarised(ds)["outputs"]["y"]
        lines = table[table["samples"] == ds.attrs["samples"]].set_index("estimate")
        assert lines.loc["mean", "value"] == entry["mean"]
        assert lines.loc["quantile 0.5", "low"] == entry["quantiles"]["0.5"]["low"]
        assert lines.loc["P(>6.0)", "high"] == entry["thresholds"]["6.0"]["above"]["high"]
        if method == "saltelli":
            index = sensitivities(ds)["outputs"]["y"]["ST"]["x4"]
            assert lines.loc["ST x4", "low"] == index["low"]


def test_only_what_is_asked_for():
    ds = kinds(samples=64)
    name = "life[side=left,depth=0.5]"
    assert set(running_estimates(ds, name)["output"]) == {name}
    assert len(set(running_estimates(ds, "life")["output"])) == 4
    with pytest.raises(InputError, match="no such output"):
        running_estimates(ds, "lif")


def test_a_design_that_does_not_grow_is_refused_with_those_that_do():
    with pytest.raises(InputError, match="'latin-hypercube' .* 'monte-carlo' or 'sobol'"):
        running_estimates(linear("latin-hypercube", 64, 8))


def with_error(size, samples=256):
    ds = linear(samples=samples)
    return with_output(ds, "y_error", np.full(samples, size))


def test_the_rows_own_error_is_held_against_that_of_sampling():
    half = (
        np.diff(list(summarised(with_error(0.0))["outputs"]["y"]["mean_interval"].values()))[0] / 2
    )
    for size, warned in ((0.9 * half, False), (1.1 * half, True)):
        line = enough(with_error(size)).loc["y"]
        assert line["sampling"] == pytest.approx(half) and line["own"] == pytest.approx(size)
        assert ("more rows do not help" in line["warning"]) is warned
    assert "y_error" not in enough(with_error(1.0)).index
    plain = enough(linear()).loc["y"]
    assert np.isnan(plain["own"]) and plain["warning"] == ""


def test_a_life_without_a_mean_is_judged_by_its_median():
    line = enough(kinds(samples=256)).loc["life[side=left,depth=0.5]"]
    assert line["estimate"] == "median" and line["sampling"] > 0


def test_errors_count_by_their_magnitude_and_for_their_own_element():
    ds = with_error(0.5)
    ds["y_error"][::2] *= -1
    assert enough(ds).loc["y", "own"] == 0.5
    ds = kinds(samples=64)
    sizes = xr.DataArray([0.1, 0.2], dims="side") * xr.ones_like(ds["work"])
    ds = ds.assign(work_error=sizes.transpose(*ds["work"].dims).assign_attrs(ds["work"].attrs))
    solver_errors = enough(ds)["own"]
    assert solver_errors["work[side=left]"] == pytest.approx(0.1)
    assert solver_errors["work[side=right]"] == pytest.approx(0.2)


def test_no_interval_is_no_warning():
    ds = with_output(linear("sobol", 64), "y_error", np.ones(64))
    assert enough(ds).loc["y", "warning"] == ""


def test_the_command_shows_and_writes_json(uq, folder):
    whole_files.write(with_error(1.0), folder / "out.nc")
    ended = uq("convergence", "out.nc")
    assert ended.code == 0
    assert "more rows do not help" in " ".join(ended.out.split())
    estimates = json.loads(uq("convergence", "out.nc", "--json").out)["outputs"]["y"]
    assert [line["samples"] for line in estimates["estimates"]["mean"]] == [16, 32, 64, 128, 256]
    assert estimates["own_error"] == 1.0 and estimates["sampling_error"] < 1.0
    whole_files.write(linear(samples=1024), folder / "long.nc")
    shown = [line.split() for line in uq("convergence", "long.nc").out.splitlines()]
    of_mean = shown[shown.index(["samples", "mean", "95", "%", "interval"]) + 1 :]
    assert [line[0] for line in of_mean[:6]] == ["32", "64", "128", "256", "512", "1024"]
    whole_files.write(linear("latin-hypercube", 64, 8), folder / "lhs.nc")
    assert uq("convergence", "lhs.nc").code == 2


def test_the_verdict_comes_first_also_of_one_output(uq, folder):
    ds = asking(linear(samples=64), outputs=["y"], thresholds={"y": 5.0})
    whole_files.write(with_output(ds, "y_error", np.full(64, 9.0)), folder / "out.nc")
    for arguments in ((), ("--output", "y")):
        first, *_ = uq("convergence", "out.nc", *arguments).out.splitlines()
        assert first.startswith("More rows needed: ")
        words = " ".join(uq("convergence", "out.nc", *arguments).out.split())
        assert words.index("more rows do not help") < words.index("samples mean")
