"""What a study will lack is said before any row is computed."""

import pytest
from own_study import own_study

from uq.errors import RunError
from uq.execution import runner
from uq.execution.loading import load_study
from uq.explore import rare_events
from uq.machines.row_by_row import undeclared_lives
from uq.study.hints import hints
from uq.study.installed_models import find_model, model_names
from uq.text.quantities import unknown_factor

PAD = """
import uq

@uq.machine(returns={"NAME": RETURNED})
def pad(load: float = 1.0):
    return {"NAME": 3.0 / load}
"""
LIFE = "is not declared as a life"


@pytest.fixture
def studied(write_function):
    """Return a function that writes a study of a machine, and returns its hints."""

    def write(name="y", returned="'1'", samples=64, analysis="", machine="", **design):
        study = own_study("pad", "load", lower=0.5, samples=samples)
        for key, value in design.items():
            before = 'method = "monte-carlo"' if key == "method" else "[uncertain"
            after = before if key != "method" else ""
            study = study.replace(before, f"{key} = {value!r}\n{after}", 1)
        text = PAD.replace("NAME", name).replace("RETURNED", returned)
        file = write_function(text, f"{study}\n[analysis]\n{analysis}")
        return hints(load_study("own.toml", machine or file))

    return write


@pytest.mark.parametrize(
    ("name", "unit"),
    [("life", "1"), ("pad_life", "s"), ("time_to_failure", "h"), ("cycles_to_crack", "cycles")],
)
def test_an_output_with_the_name_of_a_life_is_to_be_declared(studied, name, unit):
    (sentence,) = studied(name, repr(unit))
    assert sentence.startswith(f"output '{name}' {LIFE}")
    assert f"@uq.machine(returns={{'{name}': uq.Returned('s', life=True)}})" in sentence


@pytest.mark.parametrize(
    ("name", "returned"),
    [
        ("life", "uq.Returned('s', life=True)"),
        ("life", "'m'"),
        ("lifetime_error", "'1'"),
        ("relief", "'1'"),
        ("settling_time", "'s'"),
    ],
)
def test_other_outputs_are_no_lives(studied, name, returned):
    assert studied(name, returned) == []


@pytest.mark.parametrize(
    ("unit", "odd", "meant"),
    [
        ("kN qqfoo", "qqfoo", ""),
        ("hurz", "hurz", "; did you mean 'Hz'?"),
        ("newtons m", "newtons", ""),
        ("mbars", "mbars", "; did you mean 'bar'?"),
    ],
)
def test_a_unit_that_may_be_misspelt_is_named(studied, unit, odd, meant):
    (sentence,) = studied("y", repr(unit))
    assert sentence.startswith(f"output 'y' has unit '{unit}': '{odd}' is not a usual unit{meant};")
    assert "no other unit converts to it" in sentence


@pytest.mark.parametrize(
    "unit", "1 m mm kg mg N/m kPa m2 K degC mbar cycles rpm % rad kWh dB s-1 mol".split()
)
def test_usual_units_are_no_mistake(studied, unit):
    assert studied("y", repr(unit)) == []


def test_installed_models_have_usual_units():
    for model in map(find_model, model_names()):
        declared = [model.parameter(name).unit for name in model.parameter_names]
        declared += [output.unit for output in model.outputs.values()]
        assert not list(filter(None, map(unknown_factor, declared)))


def test_no_installed_model_has_an_undeclared_life():
    assert [line for name in model_names() for line in undeclared_lives(find_model(name))] == []


def test_a_program_is_to_declare_its_life(folder, studied):
    (folder / "pad.toml").write_text(
        '[machine]\nname = "pad"\ncommand = ["echo", "{load}"]\n[parameters.load]\nnominal = 1.0\n'
        "[outputs.life]\npattern = '(.*)'\n"
    )
    (sentence,) = studied(machine="pad.toml")
    assert LIFE in sentence and "life = true" in sentence


@pytest.mark.parametrize("method", ["latin-hypercube", "sobol", "halton", "saltelli", "morris"])
def test_one_replicate_has_no_interval(studied, method):
    (sentence,) = studied(method=method)
    assert "replicates = 1: no number will have an interval" in sentence
    assert f"'{method}' design" in sentence and sentence.endswith("set replicates = 8")
    assert studied(method=method, replicates=8) == []


def test_paths_have_intervals_of_their_indices_alone(studied):
    (sentence,) = studied(method="shapley")
    assert "no number but its indices will have an interval" in sentence


def test_two_replicates_have_wide_intervals(studied):
    (sentence,) = studied(method="sobol", replicates=2)
    assert "about 5.4 times as wide" in sentence  # t of one over t of seven degrees of freedom


def test_samples_of_several_units_count(studied):
    (sentence,) = studied(samples=1, units=100)
    assert "samples = 1: no number will have an interval" in sentence
    assert studied(samples=20, units=100) == []


def test_too_few_groups_give_no_indices(studied):
    (sentence,) = studied(method="saltelli", samples=4, replicates=1)[1:]
    assert sentence == "sensitivity 'sobol' needs 8 whole groups, and there will be 4 at most"


def test_ends_of_the_sample_need_rows(studied):
    analysis = "quantiles = [0.001, 0.5]\ntolerance = {coverage = 0.95, confidence = 0.95}\n"
    more = analysis + 'joint_bounds = {y = "both"}'
    assert studied(samples=58, analysis=more) == [
        "[analysis] quantiles: 0.001 of 58 rows will have no value; 999 rows are needed",
        "[analysis] tolerance: 58 rows will give no bound; 59 are needed if no row is invalid",
        "[analysis] joint_bounds: 58 rows will give no bound; 93 are needed if no row is invalid",
    ]
    assert studied(samples=999, analysis=more) == []


def test_check_and_run_say_it_before_anything_is_computed(uq, write_function, monkeypatch):
    text = PAD.replace("NAME", "life").replace("RETURNED", "'1'")
    study = own_study("pad", "load", lower=0.5, samples=64).replace("monte-carlo", "sobol")
    file = write_function(text, study)
    checked = uq("check", "own.toml", "--model", file).out
    assert LIFE in checked and "replicates = 1:" in checked
    monkeypatch.setattr(runner, "carry_out", nothing)
    first, second, last = uq("run", "own.toml", "--model", file).err.splitlines()
    assert LIFE in first and "replicates = 1:" in second and last == "nothing was computed"
    quiet = uq("run", "own.toml", "--model", file, "--quiet")
    assert quiet.err == "nothing was computed\n"


@pytest.mark.slow
def test_other_verbs_say_what_concerns_them(uq, write_function, monkeypatch, folder):
    text = PAD.replace("NAME", "life").replace("RETURNED", "'1'")
    study = own_study("pad", "load", lower=0.5, samples=64).replace("monte-carlo", "sobol")
    file = write_function(text, study)
    (folder / "seen.csv").write_text("unit,output,kind,time\nA,life,survived,2\n")
    (simulated,) = uq("simulate", file).err.splitlines()
    assert simulated.startswith(f"output 'life' {LIFE}")
    monkeypatch.setattr(runner, "carry_out", nothing)
    monkeypatch.setattr(rare_events, "rare_event", nothing)
    asked = ("own.toml", "--output", "life", "--below", 3, "--model", file)
    assert uq("rare-event", *asked).err == f"{simulated}\nnothing was computed\n"
    updated = uq("update", "own.toml", "seen.csv", "-o", "p.nc", "--model", file)
    first, second, _ = updated.err.splitlines()
    assert first == simulated and "replicates = 1:" in second


def nothing(*arguments):
    raise RunError("nothing was computed")
