"""A plain function as a machine: what a study makes of it, and what a row does to others."""

import json
import subprocess
import sys
import tomllib

import numpy as np
import pytest
from own_machines import WEAR, WEAR_STUDY

import uq as package
from uq.contract import Status
from uq.execution import child, loading
from uq.result import elements
from uq.result.result import Result


def test_a_function_becomes_a_machine_with_units_bounds_lives_and_arrays(uq, write_function):
    file = write_function(WEAR)
    assert uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet").err == ""
    ds = package.open_result("own.nc")
    load = ds["load"].values
    assert "ValueError: too heavy" in ds["status"].attrs["example_raised"]
    heavy = load > 1.9
    assert (ds["status"].values == np.where(heavy, Status.RAISED, Status.OK)).all() and heavy.any()
    is_exact = ~heavy
    expected = np.where(load < 0.1, np.inf, np.where(load < 0.2, 20.0, 3.0 / load))
    assert (ds["life"].values[is_exact] == expected[is_exact]).all()
    cut = (load >= 0.1) & (load < 0.2)
    assert (ds["life_censored"].values[is_exact] == cut[is_exact]).all() and cut.any()
    assert (ds["profile"].values[is_exact] == np.stack([load, 2 * load], axis=1)[is_exact]).all()
    assert ds["load"].attrs["units"] == "N" and ds["load"].attrs["long_name"] == "force on the pad"


@pytest.mark.slow
def test_rows_are_equal_to_the_bit_in_processes_of_their_own(uq, write_function):
    file = write_function(WEAR)
    uq("run", "own.toml", "--model", file, "-o", "here.nc", "--quiet", "--workers", "0")
    uq("run", "own.toml", "--model", file, "-o", "there.nc", "--quiet", "--workers", "2")
    assert package.open_result("here.nc").equals(package.open_result("there.nc"))
    assert "equal to the bit" in uq("verify", "there.nc", "--model", file).out


@pytest.mark.slow
def test_a_long_array_is_described_at_some_places_unless_it_is_named(
    uq, write_function, monkeypatch
):
    monkeypatch.setattr(elements, "MOST_PLACES", 12)
    text = (
        "import uq\n@uq.machine\ndef wear(load=1.0): return {'y': [[load] * 3] * 90, 'z': load}\n"
    )
    file, study = write_function(text), WEAR_STUDY.replace("100", "20")
    for more, count in (("", 3 * 4), ("[analysis]\noutputs = ['y']\n", 3 * 90)):
        file = write_function(text, study + more)
        uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet", "--fresh")
        ds = package.open_result("own.nc")
        names = [element.name for element in elements.elements_of(ds, ["y"])]
        assert len(names) == count and names[0] == "y[y_0=0,y_1=0]"
        assert names[-1] == "y[y_0=89,y_1=2]" and len(elements.named_elements(ds, "y")) == 270
        (element,) = elements.named_elements(ds, "y[y_0=17,y_1=1]")
        assert element.place == {"y_0": 17, "y_1": 1}
        sentence = "y: shown at evenly spread places, as it has 270 elements"
        assert [note[: len(sentence)] for note in Result(ds).notes_on_places] == [sentence] * (
            not more
        )


def test_a_seed_is_that_of_the_row(uq, write_function):
    file = write_function(
        "import uq\n@uq.machine\n"
        "def wear(seed, load: float = 1.0):\n    return {'y': load + seed % 7}\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet")
    noise = package.open_result("own.nc")
    assert len(np.unique(np.round(noise["y"].values - noise["load"].values))) == 7
    assert noise.attrs["random"] == 1


@pytest.mark.parametrize("workers", [0, pytest.param(2, marks=pytest.mark.slow)])
def test_a_row_that_leaves_the_program_or_its_folder_costs_that_row_only(
    uq, write_function, workers
):
    file = write_function(
        "import os, sys, uq\n@uq.machine\ndef wear(load: float = 1.0):\n"
        "    here = float(os.getcwd() != '/')\n    os.chdir('/')\n"
        "    if load > 1.9:\n        sys.exit('too heavy')\n    return {'y': here}\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet", "--workers", workers)
    ds = package.open_result("own.nc")
    heavy = ds["load"].values > 1.9
    assert (ds["status"].values == np.where(heavy, Status.RAISED, Status.OK)).all() and heavy.any()
    assert ds["status"].attrs["example_raised"].endswith("SystemExit: too heavy")
    assert (ds["y"].values[~heavy] == 1).all()


def test_what_a_file_prints_is_no_part_of_an_answer(uq, write_function):
    file = write_function(
        "import numpy as np, uq\nprint('noise')\n@uq.machine(returns={'y': '1'})\n"
        "def wear(load=np.float32(1.5)): return {'y': load}\n"
    )
    assert json.loads(uq("simulate", file, "--json").out)["outputs"] == {"y": 1.5}


def test_an_interrupt_raised_by_a_row_is_its_status(write_function, capfd):
    file = write_function(
        "import sys, warnings, uq\n@uq.machine\ndef wear(load: float = 1.0):\n"
        "    warnings.warn('noise')\n    print('noise', file=sys.stderr)\n"
        "    if load > 1.9:\n        raise KeyboardInterrupt\n    return {'y': 10**30}\n"
    )
    ds = package.run(package.load_study("own.toml", file), "own.nc")
    heavy = ds["load"].values > 1.9
    assert (ds["status"].values == np.where(heavy, Status.RAISED, Status.OK)).all() and heavy.any()
    assert ds["status"].attrs["example_raised"].endswith("KeyboardInterrupt()")
    assert (ds["y"].values[~heavy] == 1e30).all()
    captured = capfd.readouterr()
    assert "noise" not in captured.err and "Traceback" not in captured.err


def test_a_function_that_remembers_its_rows_is_noticed(uq, write_function):
    file = write_function(
        "import uq\nrows = []\n@uq.machine\ndef wear(load: float = 1.0):\n"
        "    rows.append(load)\n    return {'y': load + len(rows)}\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet", "--samples", 40)
    ended = uq("verify", "own.nc", "--model", file)
    assert ended.code == 1 and "returns other values" in " ".join(ended.out.split())
    reason = uq("row", "own.nc", 30, "--model", file).out
    assert "the model does not return the same" in " ".join(reason.split())


SLOW_TO_LEARN = """
import time, uq
@uq.machine
def wear(load: float = {nominal}):
    if load > 1.5:
        time.sleep(300)
    return {{"y": load}}
"""


@pytest.mark.slow
def test_a_nominal_row_that_hangs_is_one_line(uq, write_function, monkeypatch):
    monkeypatch.setattr(child, "FIRST_SECONDS", 0.0)
    monkeypatch.setattr(loading, "_SLOW", 0.5)
    file = write_function(SLOW_TO_LEARN.format(nominal=2.0))
    ended = uq("run", "own.toml", "--model", file, "--row-limit", "1")
    told, refused = ended.err.splitlines()
    assert told.startswith("running 65 rows, once, to see what the model returns; 'returns' in")
    assert ended.code == 2 and refused.endswith("its nominal row did not end within 1 s")


@pytest.mark.slow
def test_a_row_that_hangs_while_it_is_seen_what_is_returned_costs_that_row_only(
    uq, write_function, monkeypatch
):
    monkeypatch.setattr(child, "FIRST_SECONDS", 0.5)
    file = write_function(SLOW_TO_LEARN.format(nominal=1.0))
    ended = uq("run", "own.toml", "--model", file, "--row-limit", "0.5", "--samples", "6")
    ds = package.open_result("results/own.nc")
    slow = ds["load"].values > 1.5
    assert (ds["status"].values == np.where(slow, Status.TIMED_OUT, Status.OK)).all() and slow.any()
    assert "Traceback" not in ended.err


def test_a_row_that_ends_its_process_is_one_sentence_of_simulate(uq, write_function):
    file = write_function(
        "import ctypes, uq\n@uq.machine(returns={'y': '1'})\ndef wear(load: float = 1.0):\n"
        "    ctypes.string_at(0)\n    return {'y': load}\n"
    )
    ended = uq("simulate", file)
    assert ended.code == 1 and ended.err == ""
    assert ended.out.startswith("wear: crashed  killed its process (Segmentation fault)\n")


@pytest.mark.slow
def test_slow_rows_of_two_workers_begin_together(uq, write_function):
    file = write_function(
        "import time, uq\n@uq.machine(returns={'began': 's'})\ndef wear(load: float = 1.0):\n"
        "    began = time.time()\n    time.sleep(3)\n    return {'began': began}\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--workers", "2", "--samples", "2")
    first, second = package.open_result("own.nc")["began"].values
    assert abs(second - first) < 3


@pytest.mark.slow
def test_simulate_shows_what_a_function_prints(write_function):
    file = write_function(
        "import uq\n@uq.machine(returns={'y': '1'})\ndef wear(load: float = 1.0):\n"
        "    print('here I am')\n    return {'y': load}\n"
    )
    command = [sys.executable, "-m", "uq", "simulate", file, "--json"]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.stderr == "here I am\n" and json.loads(ended.stdout)["outputs"] == {"y": 1.0}


@pytest.mark.slow
def test_a_new_machine_passes_as_it_is_written(uq, folder):
    name = "a_new_machine"
    ended = uq("init", "--machine", name)
    assert ended.code == 0 and (folder / name / "README.md").is_file()
    file, study = (f"{name}/{name}.{ending}" for ending in ("py", "toml"))
    assert uq("check", study, "--model", file).code == 0
    assert "150 days" in uq("run", study, "--model", file, "-o", "own.nc").out
    tests = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    assert subprocess.run(tests, cwd=folder / name, stdout=subprocess.DEVNULL).returncode == 0
    assert "exists already" in uq("init", "--machine", name).err
    assert "another module" in uq("init", "--machine", "random").err


@pytest.mark.parametrize(
    ("names", "first"), [("", "8 runs, 0 invalid"), ('("test pad", "test pads")', "8 test pads, 0")]
)
def test_a_card_calls_rows_what_the_machine_calls_them(uq, write_function, names, first):
    options = f"(row_name={names})" if names else ""
    file = write_function(
        f"import uq\n@uq.machine{options}\ndef pad(load: float = 1.5): return {{'life': load}}\n"
    )
    ended = uq("run", "own.toml", "--model", file, "-o", "own.nc", "--workers", 0, "--samples", 8)
    assert first in ended.out


@pytest.mark.parametrize(
    "names", ["('pad',)", "'pad'", "('pad', 3)", "('pad', '')", "('a/b', 'c')"]
)
def test_names_of_a_row_that_are_no_words_are_refused(uq, write_function, names):
    file = write_function(
        f"import uq\n@uq.machine(row_name={names})\ndef pad(x: float = 1.0): return {{'life': x}}\n"
    )
    ended = uq("check", "own.toml", "--model", file)
    assert ended.code == 2
    assert "row_name" in ended.err and "a singular and a plural" in ended.err


DEFAULTS = """
import uq
@uq.machine(
    returns={"energy": "J", "life": uq.Returned("s", life=True)},
    headline=("life",),
    uncertain={"load": {"distribution": "normal", "mean": 1.5, "sd": 0.1, "source": "weighed"}},
)
def pad(depth: float = 3.0, load: float = 1.5): return {"life": depth / load, "energy": load}
"""


def test_a_new_study_has_the_laws_and_outputs_that_the_machine_proposes(uq, folder, write_function):
    file = write_function(DEFAULTS)
    text = uq("init", file).out
    study = tomllib.loads(text)
    assert study["uncertain"] == {
        "load": {"distribution": "normal", "mean": 1.5, "sd": 0.1, "source": "weighed"}
    }
    assert study["analysis"]["outputs"] == ["life"]
    (folder / "new.toml").write_text(text)
    ended = uq("run", "new.toml", "--model", file, "--samples", 64, "--workers", 0)
    assert (ended.code, ended.err) == (0, "")
    assert "95/95 life" in ended.out


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('("life",)', '("live",)', "headline: 'live': no such output; did you mean 'life'?"),
        ('("life",)', '"life"', "headline = 'life': must be a list of outputs"),
        ('"load": {', '"lead": {', "uncertain: 'lead': no such parameter; did you mean 'load'?"),
        ('"normal"', '"norml"', '[uncertain.load] distribution = "norml": no such law; did you'),
        ('"distribution"', '"law"', "[uncertain.load] distribution: is missing (allowed: uniform,"),
        ('"distribution"', '"distributon"', "no such key; did you mean 'distribution'?"),
        ('"sd": 0.1', '"sd": -0.1', "[uncertain.load] sd = -0.1: must be greater than 0"),
        ('"sd": 0.1', '"sigma": 0.1', "[uncertain.load] sd: is missing"),
        ('"sd": 0.1', '"sd": 0.1, "x": 1', "no such argument of load's law (allowed: "),
        ('"normal"', "5", "[uncertain.load] distribution = "),
        ('"normal"', "[]", "[uncertain.load] distribution = "),
    ],
)
def test_a_proposal_that_cannot_be_used_is_refused(uq, write_function, old, new, sentence):
    ended = uq("init", write_function(DEFAULTS.replace(old, new, 1)))
    assert (ended.code, ended.out) == (2, "")
    assert sentence in ended.err
    assert "Traceback" not in ended.err
