"""Basins of attraction: the right labels, the right places, the same bits whoever computes them."""

import os
from dataclasses import replace
from math import tau
from subprocess import run
from sys import executable
from typing import Annotated, NamedTuple

import numpy as np
import process_models
import pytest
import sample_models
import xarray as xr

import uq
from uq.contract import Model, Output, Parameter, Status
from uq.errors import InputError
from uq.explore.basins import attractors


class Start(NamedTuple):
    displacement: Annotated[float, Parameter("x", "m", "place", (-5.0, 5.0), "made up")] = 0.0
    velocity: Annotated[float, Parameter("v", "m s-1", "rate", (-5.0, 5.0), "made up")] = 0.0
    shift: Annotated[float, Parameter("s", "m", "of the wells", (-1.0, 1.0), "made up")] = 0.0


def settle(x, seed, settings):
    """Roll into the well on the side of x + v, which lies at +-1 + shift; far out, into a cycle."""
    displacement, velocity, shift = np.ascontiguousarray(x.T)
    side = displacement + velocity
    cycling = abs(side) > 4
    outputs = {
        "place": np.where(cycling, 0.0, np.sign(side)) + shift + 1e-6 * displacement,
        "mean": np.where(cycling, 3.0 + 0.1 * np.sin(1e3 * side), 0.0),
        "mean_error": np.where(cycling, 0.2, 0.0),
        "regime": np.where(cycling, 1, 0).astype(np.int8),
        "turns": np.where(cycling, displacement, np.nan),
    }
    lost = side == 0
    for values in outputs.values():
        values[lost] = -1 if values.dtype == np.int8 else np.nan
    return outputs, np.where(lost, Status.OUT_OF_BUDGET, Status.OK).astype(np.int8)


WELLS = Model(
    name="wells",
    title="Two wells and a cycle",
    version="1",
    parameters=Start,
    settings=sample_models.Settings,
    outputs={
        "place": Output("m", "where it comes to rest"),
        "mean": Output("1", "some average"),
        "mean_error": Output("1", "standard error of it"),
        "regime": Output("1", "how it ends", "category", categories=("rest", "cycle")),
        "turns": Output("1", "whatever only a cycle has", may_be_undefined=True),
    },
    batch=settle,
)
AXES = {"displacement": (-3.0, 3.0, 13), "velocity": (-2.0, 2.0, 9)}


def test_every_point_is_labelled_where_it_stands():
    ds = uq.basins(WELLS, AXES, {"shift": 0.5}, by=["place", "mean"])
    assert ds["attractor"].dims == ds["place"].dims == ("displacement", "velocity")
    np.testing.assert_array_equal(ds["displacement"], np.linspace(-3, 3, 13))
    np.testing.assert_array_equal(ds["velocity"], np.linspace(-2, 2, 9))
    assert ds["velocity"].attrs["units"] == "m s-1"
    assert ds["shift"] == 0.5
    side = ds["displacement"] + ds["velocity"]
    # As many rows roll to either side: the left well comes first on the grid.
    expected = xr.where(abs(side) > 4, 2, xr.where(side < 0, 0, xr.where(side > 0, 1, -1)))
    np.testing.assert_array_equal(ds["attractor"], expected)
    np.testing.assert_array_equal(ds["regime"] == 1, expected == 2)
    np.testing.assert_array_equal(ds["status"] == Status.OUT_OF_BUDGET, expected == -1)
    sel = ds.sel(displacement=-2.0, velocity=0.5)
    assert sel["place"] == pytest.approx(-0.5, abs=1e-5)


def test_the_table_tells_share_and_outputs_of_each_attractor():
    ds = uq.basins(WELLS, AXES, by=["place", "mean"])
    table = ds.drop_dims(list(AXES)).to_dataframe()
    counts = np.bincount(ds["attractor"].values.ravel() + 1)
    np.testing.assert_array_equal(table["share"], counts[1:] / (13 * 9))
    assert list(table["representative_regime"]) == ["rest", "rest", "cycle"]
    np.testing.assert_allclose(table["representative_place"], [-1, 1, 0], atol=1e-5)
    for label, row in table.iterrows():
        place = {name: row[f"representative_{name}"] for name in AXES}
        assert ds["attractor"].sel(place) == label


def test_all_outputs_but_errors_are_compared_by_default():
    ds = uq.basins(WELLS, AXES)
    assert ds["attractor"].attrs["compared"] == "place mean regime turns"
    # Two wells, and cycles of -3, -2.5, 2.5 and 3 turns: alike on either side, if that is allowed.
    assert ds.sizes["basin"] == 2 + 4
    coarse = uq.basins(WELLS, AXES, tolerance=0.2)
    assert coarse.sizes["basin"] == 2 + 2


def test_a_grid_may_have_any_number_of_dimensions():
    basin = uq.basins(WELLS, {"displacement": (0.5, 1.5, 3)})
    assert basin["attractor"].dims == ("displacement",)
    three = uq.basins(WELLS, {"shift": (-0.2, 0.3, 2), **AXES}, by=["mean"])
    assert three["place"].dims == ("shift", "displacement", "velocity")
    assert three["place"][1, 0, 4] == pytest.approx(-0.7, abs=1e-5)


def test_outputs_with_dimensions_keep_them():
    ds = uq.basins(sample_models.KINDS, {"x2": (0.1, 0.9, 5), "x1": (0.0, 0.9, 4)})
    assert ds["life"].dims == ("x2", "x1", "side", "depth")
    np.testing.assert_allclose(ds["life"].sel(x1=0.3)[2, 1], [0.8, 1.8])
    assert ds["representative_life"].dims == ("basin", "side", "depth")
    assert ds.sizes["basin"] == ds["attractor"].values.max() + 1


def of(*outputs, tolerance=0.01):
    columns = [np.asarray(values, float) for values in outputs]
    compared = [(values, np.zeros(len(values)), tolerance) for values in columns]
    return attractors(compared, len(columns[0])).tolist()


def test_rows_part_at_gaps_and_nowhere_else():
    assert of([5.0, 1.0, 5.04, 1.02]) == [0, 1, 0, 1]
    assert of([1.0, 1.2, 1.1, 1.3], tolerance=0.1) == [0, 0, 0, 0]  # neighbours lead across
    assert of([1.0, 2.0, 2.0, 3.0]) == [1, 0, 0, 2]
    assert of([np.inf, np.nan, 1.0, np.nan, np.inf, np.nan]) == [1, 0, 2, 0, 1, 0]
    assert of([]) == []


def test_a_gap_may_show_only_after_another_output_has_parted_the_rows():
    first, second = [0.0, 0.0, 1.0, 0.0], [0.0, 2.0, 1.0, 0.1]
    # In the second output, 1 leads from 0 to 2 until the first has taken it away.
    assert of(second, first, tolerance=0.5) == [0, 1, 2, 0]


def test_values_within_their_errors_are_alike():
    values, tolerance = np.array([1.0, 1.1, 9.0]), 1e-3
    for error, expected in ((0.0, [0, 1, 2]), (0.02, [0, 0, 1])):
        compared = (values, np.full(3, error), tolerance)
        assert attractors([compared], 3).tolist() == expected


def test_workers_give_the_bits_of_this_process():
    axes = {"x1": (0.0, 1.0, 21), "x3": (0.25, 0.75, 20)}
    settings = {"fail_above": 0.9, "fail_how": "raise"}
    here = uq.basins("linear", axes, {"x2": 0.125}, settings, tolerance=0.05, workers=0)
    there = uq.basins("linear", axes, {"x2": 0.125}, settings, tolerance=0.05, workers=2)
    assert there.identical(here)
    assert (here["attractor"] == -1).sum() == 2 * 20
    x1, x3 = here["x1"], here["x3"]
    np.testing.assert_array_equal(here["y"][:19], (x1 + 0.25 + 3.0 * x3 + 2.0)[:19])


@pytest.mark.slow
def test_workers_take_part():
    axes = {"x1": (0.0, 1.0, 12), "x2": (0.0, 1.0, 10)}
    ds = uq.basins("process_models:PROCESS", axes, settings={"seconds": 0.03}, workers=2)
    assert len(set(ds["y"].values.ravel()) - {float(os.getpid())}) == 2


def test_a_model_that_workers_would_not_find_runs_here(monkeypatch):
    monkeypatch.setattr("uq.execution.executor.SHORT_SECONDS", 0.0)
    ds = uq.basins(process_models.PROCESS, {"x1": (0.0, 1.0, 64)}, settings={"seconds": 0.02})
    assert set(ds["y"].values) == {float(os.getpid())}


@pytest.mark.slow
def test_a_plain_script_needs_no_guard(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import uq\n"
        "ds = uq.basins('linear', {'x1': (0.0, 1.0, 3), 'x2': (0.0, 1.0, 2)}, workers=1)\n"
        "print(ds['y'].values.ravel().tolist())\n"
    )
    ended = run([executable, script], capture_output=True, text=True, cwd=tmp_path, timeout=120)
    assert (ended.stdout, ended.stderr) == ("[3.5, 5.5, 4.0, 6.0, 4.5, 6.5]\n", "")


def test_what_is_in_the_file_is_not_computed_again(folder):
    calls = []

    def count(x, seed, settings):
        calls.append(len(x))
        return settle(x, seed, settings)

    counting = replace(WELLS, batch=count)
    ds = uq.basins(counting, AXES, output="some/basins.nc")
    assert sum(calls) == 13 * 9
    assert uq.basins(counting, AXES, output="some/basins.nc").identical(ds)
    assert sum(calls) == 13 * 9
    with pytest.raises(InputError, match=r"^some/basins.nc: has other contents; choose"):
        uq.basins(counting, AXES, {"shift": 0.1}, output="some/basins.nc")
    (folder / "basins.txt").write_text("no netCDF")
    with pytest.raises(InputError, match=r"^basins.txt: not a readable netCDF file"):
        uq.basins(counting, AXES, output="basins.txt")


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"axes": {}}, "axes: nothing varies; give at least one parameter its values"),
        ({"axes": ["velocity"]}, r"axes must be a dictionary with names as keys: \['velocity'\]"),
        ({"axes": {"velocty": (0.0, 1.0, 3)}}, r"velocty.*did you mean 'velocity'\?"),
        ({"axes": {"velocity": (0.0, 9.0, 3)}}, r"must be within -5.0 to 5.0 \[m s-1\]"),
        ({"axes": {"velocity": (1.0, 0.0, 3)}}, "must ascend, two finite values at least"),
        ({"axes": {"velocity": (0.0, 1.0, 1)}}, "must ascend, two finite values at least"),
        ({"axes": {"velocity": (0.0, 1.0)}}, r"must be \(first value, last value, number of"),
        ({"axes": {"velocity": (0.0, 1.0, 2.5)}}, r"must be \(first value, last value, number of"),
        ({"fixed": {"velocity": 1.0}}, "fixed: velocity = 1.0: is among the axes too"),
        ({"fixed": {"shift": "a"}}, "fixed: shift = 'a': must be a number"),
        ({"settings": {"second": 1.0}}, r"settings: second.*did you mean 'seconds'\?"),
        ({"by": ["plaice"]}, r"^by: no such output of model 'wells'; did you mean 'place'\?$"),
        ({"tolerance": -1.0}, "^tolerance must not be negative: -1.0$"),
        ({"workers": 2}, "^model 'wells' is not installed, and workers would not find it"),
    ],
)
def test_bad_input_is_one_clear_line(given, line):
    with pytest.raises(InputError, match=line) as refused:
        uq.basins(WELLS, **({"axes": AXES} | given))
    assert len(refused.value.lines) == 1


def test_all_mistakes_are_reported_at_once():
    with pytest.raises(InputError) as refused:
        uq.basins(WELLS, {"speed": (0, 1, 2)}, {"shift": 7.0}, {"seconds": "long"})
    assert len(refused.value.lines) == 3


@pytest.mark.slow
def test_the_two_attractors_of_the_paper_at_47_rad_s():
    """Ho, Nguyen & Woo 2011, figure 11: from (-0.022, 0) and from (-0.045, -1)."""
    ds = uq.basins(
        "models.mole:MODEL",
        {"initial_displacement": (-0.045, -0.022, 2), "initial_velocity": (-1.0, 0.0, 2)},
        {"control_frequency": 47 / tau},
        {"formulation": "as-printed", "transient": 300, "duration": 200},
        workers=0,
    )
    upper, other = ds["attractor"].values[1, 1], ds["attractor"].values[0, 0]
    assert upper != other
    rates = ds["representative_progression_rate"]
    np.testing.assert_allclose(rates[[upper, other]], [0.0357, 0.0427], atol=1e-4)
    assert ds["representative_regime"].values.tolist().count("quasi-periodic") >= 1
    assert ds["representative_regime"].values[other] == "undecided"
