"""``uq simulate``: one row, as text and as JSON, and its trajectory in files."""

from dataclasses import replace
from pathlib import Path

import pytest
import xarray as xr
from command_line import everything, strict_json
from sample_models import KINDS

import uq as api
from uq.cli.simulate import show_outputs
from uq.result.one_row import run_row


def test_simulate_prints_values_with_units_and_meaning(uq):
    ended = uq("simulate", "exponential-wear", "--set", "depth=1e-3")
    assert ended.code == 0
    for words in ("life [days]", "time until the depth is reached", "46.296  4e+06 s"):
        assert words in ended.out
    assert "never" in uq("simulate", "exponential-wear", "--set", "threshold=1").out


def simulate(uq, *arguments):
    ended = uq("simulate", "sample_models:KINDS", "--json", *arguments)
    return ended.code, strict_json(ended.out)


def test_simulate_as_json(uq):
    code, document = simulate(uq, "--set", "x1=0.1", "--set", "x2=0.1")
    assert code == 0
    assert document == {
        "model": "kinds",
        "inputs": {"x1": 0.1, "x2": 0.1},
        "outputs": {
            "work": [0.1, 0.1],
            "life": [[None, None], [None, None]],
            "angle": None,
            "regime": "slow",
        },
        "status": {"code": "ok", "meaning": "The row was computed."},
        "never": [f"life[side={s},depth={d}]" for s in ("left", "right") for d in (0.5, 1.5)],
        "censored": [],
        "undefined": ["angle"],
    }
    code, document = simulate(uq, "--set", f"x1={1 / 1.1!r}")
    assert code == 0
    assert document["outputs"]["life"][0][0] == 1 / 1.1 + 0.5
    assert len(document["censored"]) == 4
    assert document["never"] == document["undefined"] == []


@pytest.mark.parametrize("how", ["nan", "inf"])
def test_a_setting_may_be_a_word_that_toml_reads_as_a_number(uq, how):
    faults = ("--set", "x1=0.9", "--setting", "fail_above=0.5", "--setting", f"fail_how={how}")
    document = strict_json(uq("simulate", "linear", "--json", *faults).out)
    assert document["status"] == {"code": "non-finite", "meaning": f"'y' is {how}"}


def test_a_failed_row_is_reported(uq):
    faults = ("--set", "x1=0.9", "--setting", "fail_above=0.5", "--setting", "fail_how=raise")
    ended = uq("simulate", "linear", *faults)
    assert ended.code == 1
    assert "raised" in ended.out
    assert "ValueError: x1 is above fail_above = 0.5" in ended.out
    assert "y" not in ended.out.split()  # what it has no value of is not listed
    document = strict_json(uq("simulate", "linear", "--json", *faults).out)
    assert document["outputs"] == {"y": None}
    assert document["undefined"] == []
    assert document["status"] == {
        "code": "raised",
        "meaning": "ValueError: x1 is above fail_above = 0.5",
    }


def test_a_trajectory_is_written_and_drawn(uq, folder):
    ended = uq("simulate", "sample_models:KINDS", "-o", "t.nc", "--plot", "t.png")
    assert ended.code == 0
    with xr.open_dataset("t.nc") as ds:
        assert ds["trajectory"].dims == ("time", "quantity")
    assert Path("t.png").read_bytes().startswith(b"\x89PNG")
    assert everything(folder) == ["t.nc", "t.png"]


def test_a_trajectory_overwrites_nothing_but_a_trajectory(uq, write_study, folder):
    uq("run", write_study(), "-o", "study.nc", "--quiet", "--workers", 0)
    xr.Dataset({"trajectory": ("time", [0.0, 1.0])}).to_netcdf("foreign.nc")
    api.simulate("linear").to_netcdf("row.nc")
    Path("notes.txt").write_text("precious")
    Path("empty").touch()
    for path in sorted(folder.iterdir()):
        before = path.read_bytes()
        ended = uq("simulate", "sample_models:KINDS", "-o", path.name)
        assert (ended.code, ended.out) == (2, "")
        assert ended.err == (
            f"{path.name}: exists and is not a trajectory of 'uq simulate'; choose another name\n"
        )
        assert path.read_bytes() == before

    for place in ("0.25", "0.5"):
        ended = uq("simulate", "sample_models:KINDS", "-o", "t.nc", "--set", f"x1={place}")
        assert (ended.code, ended.err) == (0, "")
        with xr.open_dataset("t.nc") as ds:
            assert ds["x1"] == float(place)


def test_a_label_may_end_with_a_bracket(capsys):
    labelled = replace(KINDS, coordinates=lambda settings: {"side": ("a[1]", "b"), "depth": (1, 2)})
    show_outputs(run_row(labelled, {}, {}))
    assert "side=a[1]  " in capsys.readouterr().out
