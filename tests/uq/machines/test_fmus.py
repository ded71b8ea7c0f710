"""An FMU as a machine: what a study makes of it, what goes wrong, what it leaves behind."""

import sys
from math import inf, nan
from pathlib import Path

import cooling_fmu
import numpy as np
import pytest
from cooling_fmu import DESCRIPTION, DESCRIPTION_3, EXPERIMENT
from own_machines import opened
from own_study import own_study

from uq.contract import Status
from uq.machines.fmu import reduced
from uq.machines.fmu_description import FmuOutputTable, cf_unit
from uq.machines.returned import Censored
from uq.study.installed_models import model_at

MACHINE = """
[machine]
name = "body"
fmu = "body.fmu"
stop = 5.0
step = 0.05
[parameters.rate]
variable = "body.rate"
bounds = [0.0, 10.0]
[parameters.fault]
[outputs.last]
variable = "T"
[outputs.hottest]
variable = "T"
over_time = "max"
[outputs.average]
variable = "T"
over_time = "mean"
[outputs.life]
variable = "T"
below = 330.0
[outputs.steps]
unit = "1"
"""


@pytest.fixture(scope="session")
def library(tmp_path_factory):
    return cooling_fmu.compiled(tmp_path_factory.mktemp("fmu"))


@pytest.fixture
def body(folder, library):
    """Write the FMU, a machine file that names it and nothing else."""
    cooling_fmu.write(folder / "body.fmu", library)
    (folder / "body.toml").write_text(MACHINE)


def run(uq, model, *more, name="rate", lower=0.1, upper=2.0):
    Path("own.toml").write_text(own_study("body", name, lower, upper))
    ended = uq("run", "own.toml", "--model", model, "-o", "own.nc", "--quiet", *more)
    return ended, opened()


def test_an_fmu_alone_has_its_own_parameters_and_outputs(uq, body, folder):
    ended, ds = run(uq, "body.fmu", name="body_rate")
    assert ended.err == ""
    assert np.allclose(ds["T"], 300 + 100 * np.exp(-4 * ds["body_rate"]), rtol=1e-12, atol=0)
    assert ds["T"].attrs["units"] == ds["T0"].attrs["units"] == "K"
    assert ds["body_rate"].attrs["units"] == "s-1"
    assert ds["body_rate"].attrs["long_name"] == "rate of cooling"
    assert ds.attrs["model_version"] == "FMI 2.0"
    shown = uq("models", "body.fmu").out
    assert "0 to 50" in shown and "label" not in shown
    left = {"body.fmu", "body.toml", "own.toml", "own.nc"}
    assert {path.name for path in folder.iterdir()} == left


def test_an_fmu_of_fmi_3_has_the_rows_of_fmi_2(uq, body, folder, library):
    _, ds = run(uq, "body.fmu", name="body_rate")
    cooling_fmu.write(folder / "body.fmu", library, DESCRIPTION_3)
    ended, new = run(uq, "body.fmu", "--fresh", name="body_rate")
    assert ended.err == ""
    assert (new["T"] == ds["T"]).all() and (new["steps"] == 400).all()
    assert new["T"].attrs["units"] == new["T0"].attrs["units"] == "K"
    assert new.attrs["model_version"] == "FMI 3.0"
    shown = uq("models", "body.fmu").out
    assert "0 to 50" in shown and not {"field", "count", "tick", "time"} & set(shown.split())


def test_a_fault_of_an_fmu_of_fmi_3_is_one_sentence(uq, body, folder, library):
    cooling_fmu.write(folder / "body.fmu", library, DESCRIPTION_3)
    _, ds = run(uq, "body.toml", "--samples", "2", name="fault", lower=0.5, upper=1.5)
    words = "fmi3DoStep failed with status 3 (error). (no heat is left); see "
    assert words in ds["status"].attrs["example_raised"]


def test_an_array_of_an_fmu_is_refused_in_one_line(uq, body, folder, library):
    cooling_fmu.write(folder / "body.fmu", library, DESCRIPTION_3)
    text = MACHINE.replace("[outputs.steps]", '[outputs.steps]\nvariable = "field"')
    (folder / "body.toml").write_text(text)
    ended = uq("models", "body.toml")
    assert ended.code == 2 and ended.err.count("\n") == 1
    assert 'steps.variable = "field": is an array; let the FMU declare' in ended.err


def test_variables_are_reduced_over_time(uq, body):
    _, ds = run(uq, "body.toml")
    rate = ds["rate"].values
    assert (ds["status"] == 0).all() and (ds["hottest"] == 400).all()
    assert np.allclose(ds["last"], 300 + 100 * np.exp(-5 * rate), rtol=1e-12, atol=0)
    mean = 300 + 100 * (1 - np.exp(-5 * rate)) / (5 * rate)
    assert np.allclose(ds["average"], mean, rtol=1e-4, atol=0)
    life = -np.log(0.3) / rate
    cut = ds["life_censored"].values.astype(bool)
    assert (cut == (life > 5)).all() and cut.any() and not cut.all()
    assert np.allclose(ds["life"].values[~cut], life[~cut], rtol=0, atol=0.05**2)
    assert (ds["life"].values[cut] == 5).all() and ds["life"].attrs["units"] == "s"


def test_a_variable_that_is_a_word_of_python_gets_another_name(uq, folder, library):
    cooling_fmu.write(folder / "body.fmu", library, DESCRIPTION.replace('"T0"', '"lambda"'))
    shown = uq("models", "body.fmu")
    assert shown.code == 0 and "lambda_" in shown.out


def test_each_row_has_an_instance_of_its_own(uq, body):
    _, ds = run(uq, "body.toml")
    assert (ds["steps"] == 100).all()  # the library counts those of all its instances


def test_an_fmu_for_model_exchange_is_integrated(uq, folder, library):
    cooling_fmu.write(folder / "body.fmu", library, cooling_fmu.FOR_MODEL_EXCHANGE)
    _, ds = run(uq, "body.fmu", name="body_rate")
    assert np.allclose(ds["T"], 300 + 100 * np.exp(-4 * ds["body_rate"]), rtol=1e-4, atol=0)


@pytest.mark.slow
def test_rows_are_equal_to_the_bit_in_processes_of_their_own(uq, body):
    _, here = run(uq, "body.toml", "--workers", "0")
    _, there = run(uq, "body.toml", "--workers", "2", "--fresh")
    assert here.equals(there)


FAULTS = {
    1: ("raised", "fmi2DoStep failed with status 3 (error). (no heat is left); see "),
    2: ("raised", "fmi2DoStep failed with status 4 (fatal). (no heat is left); see "),
    3: ("non_finite", "'last' is nan; see "),
    4: ("crashed", "killed its process (Aborted); see "),
    5: ("timed_out", "did not end within 1 s; see "),
}


@pytest.mark.parametrize(
    "fault", [1, 2, 3, *(pytest.param(n, marks=pytest.mark.slow) for n in (4, 5))]
)
def test_a_fault_costs_its_row_and_keeps_its_folder(uq, body, folder, fault):
    limits = {"name": "fault", "lower": fault - 0.5, "upper": fault + 0.5}
    ended, ds = run(uq, "body.toml", "--row-limit", "1", "--samples", "2", **limits)
    label, words = FAULTS[fault]
    struck = ds["fault"].values >= fault
    assert struck.any() and "Traceback" not in ended.err
    lost = ds["status"].values[struck]
    assert {Status(code).name.lower() for code in lost} == {label}
    sentence = ds["status"].attrs[f"example_{label}"]
    assert words in sentence
    kept = Path(sentence.rpartition("; see ")[2])
    assert kept.is_dir() and kept.parent == folder / "body.rows"
    if label == "raised":
        assert (kept / "log.txt").read_text() == "no heat is left"
        assert (kept / "trace.txt").is_file()
    assert all(path.name.startswith("failed-") for path in kept.parent.iterdir())


@pytest.mark.slow
def test_an_fmu_that_crashes_is_one_sentence_of_simulate(uq, body, folder):
    ended = uq("simulate", "body.toml", "--set", "fault=4")
    sentence = "body: crashed killed its process (Aborted); see "
    assert ended.code == 1 and " ".join(ended.out.split()).startswith(sentence)
    (kept,) = (folder / "body.rows").iterdir()
    assert f" {kept}\n" in ended.out  # in one piece


def test_another_fmu_is_noticed(uq, body, library):
    run(uq, "body.toml")
    other = DESCRIPTION.replace("temperature", "heat")
    cooling_fmu.write("body.fmu", library, other)
    assert "other code" in run(uq, "body.toml")[0].err


def test_an_fmu_that_changes_while_rows_are_computed_costs_them(body):
    model = model_at("body.toml")
    Path("body.fmu").write_bytes(Path("body.fmu").read_bytes() + b"\n")
    x, seed = np.array([[0.5, 0.0]]), np.zeros(1, np.uint64)
    _, status, messages = model.batch(x, seed, model.settings())
    assert status == Status.RAISED and "changed after the run began" in messages[0]
    assert model_at("body.toml").batch(x, seed, model.settings())[1] == Status.OK


MISTAKES = {
    ('"body.fmu"', '"bodi.fmu"'): "bodi.fmu: no such file; did you mean 'body.fmu'?",
    ('"body.rate"', '"body.rat"'): "no such parameter of the FMU; did you mean 'body.rate'?",
    ('"body.rate"', '"label"'): "no such parameter of the FMU",
    ("[outputs.steps]", "[outputs.stepz]"): "no such variable of the FMU; did you mean 'steps'?",
    ("stop = 5.0", "stop = -5.0"): "[machine] stop = -5.0: must be greater than 0",
    ("stop = 5.0", "stopp = 5.0"): "[machine] stopp = 5.0: no such key; did you mean 'stop'?",
    ('"mean"', '"average"'): "[outputs] average.over_time",
    ("below = 330.0", 'below = 330.0\nover_time = "end"'): "one of over_time, above and below",
    ("below = 330.0", 'below = 330.0\nunit = "h"'): "at which a level is reached is in s",
    ("[0.0, 10.0]", "[1.0, 10.0]"): "nominal value 0.5 of 'rate' must be",
}


@pytest.mark.parametrize("change", MISTAKES)
def test_a_mistake_in_a_machine_file_is_one_line(uq, body, folder, change):
    (folder / "body.toml").write_text(MACHINE.replace(*change))
    ended = uq("models", "body.toml")
    assert (ended.code, ended.out) == (2, "")
    assert MISTAKES[change] in ended.err and ended.err.count("\n") == 1


TWICE = DESCRIPTION.replace('"T0"', '"body_rate"')
ONLY_SCHEDULED = DESCRIPTION_3.replace("CoSimulation", "ScheduledExecution")
ODD_STEP = EXPERIMENT.replace("0.01", "0.03")
BAD = {
    "no archive": (None, "not an FMU: BadZipFile"),
    "no description": ({"description": "<x/>"}, "not an FMU"),
    "of FMI 1.0": (
        {"description": DESCRIPTION.replace('fmiVersion="2.0"', 'fmiVersion="1.0"')},
        "is of FMI 1.0, not 2.0 or 3.0; export it as such",
    ),
    "scheduled only": (
        {"description": ONLY_SCHEDULED},
        "is neither for co-simulation nor for model exchange",
    ),
    "for elsewhere": ({"platform": "win64"}, "has no binary for linux64 (there: none)"),
    "two of a name": (
        {"description": TWICE},
        "'body.rate' and 'body_rate' would both be 'body_rate'",
    ),
    "endless": ({"experiment": ""}, "states no stop time"),
    "in whole steps": (
        {"description": DESCRIPTION.replace("true", "false"), "experiment": ODD_STEP},
        "does whole steps of 0.03 s only; they do not end at 4 s",
    ),
}


@pytest.mark.parametrize("what", BAD)
def test_a_bad_fmu_is_one_line(uq, folder, library, what):
    change, words = BAD[what]
    if change is None:
        Path("bad.fmu").write_text("no archive")
    else:
        cooling_fmu.write(folder / "bad.fmu", library, **change)
    ended = uq("models", "bad.fmu")
    assert (ended.code, ended.out) == (2, "")
    assert words in ended.err and ended.err.count("\n") == 1


def test_without_fmpy_it_is_said_what_to_install(uq, folder, monkeypatch):
    Path("body.fmu").write_text("")
    monkeypatch.setitem(sys.modules, "fmpy", None)
    assert "needs FMPy: pip install 'vibrolife[fmu]'" in uq("models", "body.fmu").err


TIME, HEAT = np.array([1.0, 2.0, 2.0, 4.0]), np.array([0.0, 1.0, 3.0, 2.0])
REDUCED = {
    "end": ({"over_time": "end"}, 2.0),
    "max": ({"over_time": "max"}, 3.0),
    "min": ({"over_time": "min"}, 0.0),
    "mean": ({"over_time": "mean"}, (0.5 + 5.0) / 3),
    "a level between two values": ({"above": 0.25}, 0.25),
    "a level that is jumped over": ({"above": 2.0}, 1.0),
    "a level that is reached in the end": ({"above": 3.0}, 1.0),
    "a level that is never reached": ({"above": 3.5}, Censored(3.0)),
    "a level reached from the start": ({"below": 0.0}, 0.0),
}


@pytest.mark.parametrize("what", REDUCED)
def test_a_history_becomes_a_number(what):
    how, expected = REDUCED[what]
    assert reduced(FmuOutputTable(**how), TIME, HEAT) == expected


@pytest.mark.parametrize("bad", [nan, inf])
def test_a_history_with_a_number_that_is_none_has_no_life(bad):
    assert np.isnan(reduced(FmuOutputTable(above=0.5), TIME, np.array([0.0, 1.0, bad, 2.0])))


@pytest.mark.parametrize(
    ("unit", "expected"),
    [("W/(m2.K)", "W m-2 K-1"), ("rad/s", "rad s-1"), ("m3/s", "m3 s-1"), ("", "1"), ("%", "%")],
)
def test_units_of_modelica_are_those_of_cf(unit, expected):
    assert cf_unit(unit) == expected
