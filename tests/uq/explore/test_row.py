"""One row of a result: found, shown, and computed again to the bit."""

from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from command_line import everything, strict_json
from computed import UNIFORM, as_text, computed, kinds, linear, study_of, with_output, with_status
from drawn import words
from input_studies import tables
from nested_studies import nested
from noisy_studies import noisy

import uq as api
from uq.contract import Status
from uq.errors import InputError
from uq.explore.single_rows import row_again
from uq.result.result import Result
from uq.study.definition import study_from_text

KINDS = "sample_models:KINDS"
NOISY = "sample_models:NOISY"

CASES = {
    "monte-carlo": (lambda: linear(), None),
    "saltelli": (lambda: linear("saltelli", 16, 2, second_order=True), None),
    "morris": (lambda: linear("morris", 8), None),
    "fast": (lambda: linear("fast", 65), None),
    "rbd-fast": (lambda: linear("rbd-fast", 50), None),
    "levels": (lambda: computed(nested()), None),
    "random": (lambda: computed(noisy(samples=8, replicates=2)), NOISY),
    "random, levels": (lambda: computed(nested({"x1": "shared"}, model=NOISY)), NOISY),
    "every kind": (lambda: kinds(), KINDS),
    "failures": (lambda: linear(settings={"fail_above": 0.6, "fail_how": "raise"}), None),
}


@pytest.mark.parametrize("case", CASES)
def test_rows_of_every_design_are_computed_again_to_the_bit(case):
    make, model = CASES[case]
    ds = make()
    for number in np.linspace(0, ds.sizes["row"] - 1, 7).astype(int):
        recomputed = row_again(Result(ds), int(number), model=model)
        assert recomputed.equal and not recomputed.reason
        assert recomputed.again.status[0] == ds["status"][number]
        changed = ds.assign(x1=ds["x1"] * (1 + 2e-16))
        assert row_again(Result(changed), int(number), model=model).differing == ("x1",)


def test_a_row_is_that_of_simulate_and_says_where_it_comes_from(uq, write_study):
    uq("run", write_study("linear", "saltelli", 16, uncertain=("x1", "x3")), "-o", "out.nc")
    document = strict_json(uq("row", "out.nc", 6, "--json").out)
    ds = api.open_result("out.nc")
    values = [f"--set={name}={value!r}" for name, value in document["inputs"].items()]
    once = strict_json(uq("simulate", "linear", "--json", *values).out)
    assert once.items() <= document.items()
    assert document["row"] == 6 and document["equal"] is True
    assert document["inputs"]["x1"] == ds["x1"][6] and document["inputs"]["x2"] == 0.5
    assert document["place"] == {"replicate": 0, "group": 1, "block": "AB_x3"}
    shown = uq("row", "out.nc", 6).out
    assert "linear, row 6 of 64: ok" in shown and "block AB_x3" in shown
    assert f"x1  {ds['x1'][6].item():.5g}" in shown and "x2  " not in shown
    assert "Computed again: equal to the bit." in shown
    row = api.row("out.nc", 6)
    assert row["equal"].item() is True and row["y"].item() == ds["y"][6]


def test_units_are_prefixed(uq, write_study):
    law = 'distribution = "uniform", lower = 1e-4, upper = 3e-4'
    uq("run", write_study("exponential-wear", uncertain=("depth",), law=law), "-o", "out.nc")
    depth = api.open_result("out.nc")["depth"][3].item()
    assert f"depth  {1e6 * depth:.5g} µm" in uq("row", "out.nc", 3).out


LIVES = [5.0, 7.0, np.inf, 3.0, np.nan, 6.0, 4.0, 5.0]
CENSORED = [False, False, False, True, False, True, False, False]


def with_lives():
    """Return a result in whose row 4 a life is undefined, and whose row 6 failed."""
    ds = with_output(linear(samples=8), "life", LIVES, "lifetime", CENSORED)
    ds["life"].attrs["may_be_undefined"] = 1
    return with_status(ds, 6, Status.NON_FINITE)


def test_lives_are_ordered_ended_censored_never():
    ds = with_lives()
    lowest = row_again(Result(ds), lowest="life")
    assert lowest.number == 0
    assert lowest.choice.words == "the lowest life; 1 row was censored earlier"
    assert row_again(Result(ds.isel(row=[2, 3, 5])), lowest="life").number == 3
    assert row_again(Result(ds.isel(row=[2, 4, 6])), lowest="life").number == 2
    highest = row_again(Result(ds.isel(row=[0, 2])), highest="life")
    assert highest.choice.words == "the highest life" and highest.number == (
        0 if LIVES[0] > LIVES[2] else 2
    )
    assert row_again(Result(ds), highest="life").number in np.flatnonzero(np.isinf(LIVES))
    with pytest.raises(InputError, match="no row has a value of 'life'"):
        row_again(Result(ds.isel(row=[4, 6])), lowest="life")


@pytest.mark.parametrize("p", [0.05, 0.3, 0.5, 0.9])
def test_the_row_near_a_quantile_is_the_closest_to_that_of_the_summary(p):
    ds = kinds(samples=200, analysis={"quantiles": [p]})
    quantile = api.summary(ds)[f"q{p}"]
    for name in ("work[side=left]", "angle"):
        recomputed = row_again(Result(ds), near_quantile=(p, name), model=KINDS)
        values = ds["angle"] if name == "angle" else ds["work"].sel(side="left")
        distance = np.abs(values - quantile[name]).values
        assert (
            distance[recomputed.number] == pytest.approx(np.nanmin(distance)) and recomputed.equal
        )


def test_the_row_near_a_quantile_of_lives_may_never_end():
    ds = kinds(samples=200)
    name = "life[side=left,depth=0.5]"
    flags = ds["life_censored"][:, 0, 0].values.astype(bool)
    life = ds["life"][:, 0, 0].values
    number = row_again(Result(ds), near_quantile=(0.95, name), model=KINDS).number
    assert np.isinf(life[number]) and not flags[number]
    ended = int((~flags & np.isfinite(life)).sum())
    number = row_again(Result(ds), near_quantile=((ended + 2) / 200, name), model=KINDS).number
    assert flags[number]
    assert (
        row_again(Result(ds), lowest="life", model=KINDS).number
        == np.where(flags, 9.0, life).argmin()
    )


@pytest.mark.parametrize(
    ("chosen", "words"),
    [
        ({}, "give one of: the number of a row, --lowest, --highest, --near-quantile"),
        ({"number": 1, "lowest": "angle"}, "give one of: the number of a row"),
        ({"number": 64}, "no such row: 64 (allowed: 0 to 63)"),
        ({"number": -1}, "no such row: -1 (allowed: 0 to 63)"),
        ({"lowest": "angel"}, "no such output 'angel'; did you mean 'angle'?"),
        ({"lowest": "regime"}, "'regime' is a category, not a number"),
        ({"lowest": "work[side=lefty]"}, "did you mean 'work[side=left]'?"),
        ({"near_quantile": (0.5, "work")}, "choose one of 'work[side=left]', 'work[side=right]'"),
        ({"near_quantile": (5.0, "angle")}, "must be between 0 and 1; write 0.05 for 5 %"),
        ({"near_quantile": (1e-6, "angle")}, "a 0.0001 % quantile needs 999999 rows"),
        ({"near_quantile": (1e-300, "angle")}, "quantile needs more than 1e+09 rows"),
    ],
)
def test_a_choice_that_makes_no_sense_is_one_line(chosen, words):
    with pytest.raises(InputError) as refusal:
        row_again(Result(kinds()), model=KINDS, **chosen)
    assert words in str(refusal.value) and "\n" not in str(refusal.value)


def test_there_is_no_quantile_where_rows_follow_no_law():
    with pytest.raises(InputError, match="no quantiles: the rows of a 'morris' design do not"):
        row_again(Result(linear("morris", 8)), near_quantile=(0.5, "y"))


def test_a_failed_row_fails_again_for_the_same_reason(uq, write_study):
    more = '[settings]\nfail_above = 0.5\nfail_how = "raise"\n[analysis]\nmax_failed = 1.0'
    uq("run", write_study("linear", more=more, uncertain=("x1",)), "-o", "out.nc", "--quiet")
    ds = api.open_result("out.nc")
    number = int((ds["status"].values == Status.RAISED).argmax())
    assert uq("rerun", "out.nc", "--failed", "--setting", "fail_above=0.6").code == 0
    ended = uq("row", "out.nc", number)
    assert ended.code == 0 and "equal to the bit" in ended.out  # with the settings of this row
    last = int((api.open_result("out.nc")["status"].values == Status.RAISED).argmax())
    document = strict_json(uq("row", "out.nc", last, "--json").out)
    meaning = "ValueError: x1 is above fail_above = 0.6"
    assert document["status"] == {"code": "raised", "meaning": meaning}
    assert document["equal"] and document["outputs"] == {"y": None}
    assert f"raised  {meaning}" in " ".join(uq("row", "out.nc", last).out.split("\n"))


@pytest.mark.slow
def test_a_row_that_crashed_crashes_again_but_not_this_process(uq, write_study):
    more = '[settings]\nfail_above = 0.5\nfail_how = "exit"\n[analysis]\nmax_failed = 1.0'
    path = write_study("linear", samples=12, more=more, uncertain=("x1",))
    assert uq("run", path, "-o", "out.nc", "--quiet").code == 0
    ds = api.open_result("out.nc")
    number = int((ds["status"].values == Status.CRASHED).argmax())
    document = strict_json(uq("row", "out.nc", number, "--json").out)
    assert document["status"]["code"] == "crashed" and document["equal"]
    assert "killed its process" in document["status"]["meaning"]


def test_a_row_that_outlived_its_limit_is_not_computed_again():
    recomputed = row_again(Result(with_status(linear(), 3, Status.TIMED_OUT)), 3)
    assert not recomputed.equal and recomputed.again is None
    assert recomputed.reason == "it cannot be computed again: it outlived its time limit"


def test_what_differs_is_named_with_its_reason(uq, write_study):
    uq("run", write_study(samples=12), "-o", "out.nc", "--quiet", "--workers", 0)
    with netCDF4.Dataset("out.nc", "a") as file:
        file["y"][3] += 1e-12
    document = strict_json(uq("row", "out.nc", 3, "--json").out)
    there, here = document["outputs"]["y"], document["again"]["outputs"]["y"]
    assert (document["equal"], document["differing"]) == (False, ["y"]) and here != there
    assert document["reason"] == (
        "either out.nc has been changed, which 'uq verify' checks, or the model does not return the"
        " same for the same row"
    )
    ended = uq("row", "out.nc", 3)
    assert ended.code == 1 and "Computed again: differs in y. Reason: " in ended.out
    for name, value, reason in (
        ("numpy", "0.9", "it was computed with another numpy"),
        ("code", "0", "another version of the code of the model computed it"),
        ("study_identity", "0", "another model computed it (the nominal values"),
    ):
        with netCDF4.Dataset("out.nc", "a") as file:
            file.setncattr(name, value)
        ended = uq("row", "out.nc", 3)
        assert ended.code == 1 and reason in " ".join(ended.out.split())
    sound = uq("row", "out.nc", 4)
    assert sound.code == 0
    assert "equal to the bit; the code of the model has changed since" in sound.out


def test_without_its_model_a_row_is_shown_alone(uq, write_study):
    path = write_study(uncertain=("x1", "x2"))
    uq("run", path, "-o", "out.nc", "--model", KINDS, "--quiet", "--workers", 0)
    assert strict_json(uq("row", "out.nc", 1, "--model", KINDS, "--json").out)["equal"]
    document = strict_json(uq("row", "out.nc", 1, "--json").out)
    assert document["equal"] is False and document["outputs"]["regime"] in ("slow", "fast")
    assert document["reason"].startswith("it cannot be computed again: ")
    with netCDF4.Dataset("out.nc", "a") as file:
        file.setncattr("study", file.study.replace('"ishigami"', '"gone"'))
    ended = uq("row", "out.nc", 1)
    assert ended.code == 0 and "no such model 'gone'" in " ".join(ended.out.split())


def test_a_model_that_is_not_that_of_the_rows_is_refused(uq, write_study):
    uq("run", write_study(), "-o", "out.nc", "--quiet", "--workers", 0)
    for model, line in (
        ("linear", "--model linear: is 'linear'; the rows are of 'ishigami'"),
        ("nowhere:X", "model 'nowhere:X' cannot be imported"),
    ):
        ended = uq("row", "out.nc", 1, "--model", model)
        assert (ended.code, ended.out) == (2, "") and ended.err.startswith(line)


def test_imported_rows_are_computed_again_too(tmp_path):
    x = np.random.default_rng(3).uniform(0.1, 0.9, (20, 2))
    xr.Dataset({"x1": ("n", x[:, 0]), "x2": ("n", x[:, 1])}).to_netcdf(tmp_path / "rows.nc")

    given = tables({"x1": UNIFORM, "x2": UNIFORM}, "imported", 20, design={"file": "rows.nc"})
    ds = computed(study_from_text(as_text(given), folder=tmp_path))
    recomputed = row_again(Result(ds), 7)
    assert recomputed.equal and recomputed.again.values["x2"] == x[7, 1]


def test_the_trajectory_of_a_row_is_that_of_its_inputs_and_seed(uq, write_study, folder):
    path = write_study(uncertain=("x1",))
    uq("run", path, "-o", "out.nc", "--model", KINDS, "--quiet", "--workers", 0)
    recomputed = api.row("out.nc", lowest="work[side=left]", model=KINDS)
    lowest = api.open_result("out.nc")["x1"].min().item()
    assert recomputed["trajectory"].sel(quantity="x")[-1] == recomputed["x1"].item() == lowest
    assert "trajectory" not in api.row("out.nc", 0, model=KINDS, trajectory=False)
    given = ("--lowest", "work", "--model", KINDS)
    assert uq("row", "out.nc", *given, "--plot", "new/t.png").code == 0
    assert Path("new/t.png").read_bytes().startswith(b"\x89PNG")
    recomputed.to_netcdf("kept.nc")
    refused = uq("row", "out.nc", *given, "--plot", "t.xyz")
    assert refused.code == 2 and "t.xyz: Format 'xyz' is not supported" in refused.err
    refused = uq("row", "out.nc", *given, "--plot", "/proc/t.png")
    assert refused.code == 2 and "choose another place with --plot" in refused.err
    assert everything(folder) == ["kept.nc", "new", "new/t.png", "out.nc", "small.toml"]


def test_a_row_of_a_sample_of_several_units_is_drawn():
    ds = computed(nested({"x1": "own", "x2": "chance"}, KINDS, samples=2))
    recomputed = api.row(ds, 3, model=KINDS)
    assert recomputed["unit"].item() == ds["unit"].values[3]
    assert recomputed["trajectory"]["units"].values[0] == "m"
    assert "[" in words(api.plots.motion(recomputed))


def test_a_study_of_one_row_has_a_row():
    design = {"method": "monte-carlo", "samples": 1}
    given = {
        "study": {"name": "one", "model": "linear"},
        "design": design,
        "uncertain": {"x1": UNIFORM},
    }
    assert row_again(Result(computed(study_of(given))), 0).equal
