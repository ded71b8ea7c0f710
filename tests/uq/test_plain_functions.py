"""A plain function as a machine: what a study makes of it, and what goes wrong."""

import itertools
import json
import subprocess
import sys

import numpy as np
import pytest
from computed import summarised

import uq as package
from uq.contract import Status
from uq.outside.compiled import Compiled
from uq.outside.row_by_row import RowByRow
from uq.rows import elements
from uq.running import child, loading
from uq.study.registry import find_model

STUDY = """
[study]
name = "own"
model = "wear"
[design]
method = "monte-carlo"
samples = 100
seed = 1
[uncertain.load]
distribution = "uniform"
lower = 0.0
upper = 2.0
source = "assumed"
"""

WEAR = '''
import math
from typing import Annotated
import uq

@uq.machine
def wear(load: Annotated[float, "N", (0.0, 10.0), "force on the pad"] = 1.0, depth: float = 3.0):
    """Wear of a pad."""
    if load > 1.9:
        raise ValueError("too heavy")
    life = math.inf if load < 0.1 else uq.censored(20.0) if load < 0.2 else depth / load
    return {"life": life, "profile": [load, 2 * load]}
'''

_numbers = itertools.count()


@pytest.fixture
def write(folder):
    """Return a function that writes a module of its own, and returns the name of its file."""

    def write(text, study=STUDY):
        name = f"own_machine_{next(_numbers)}.py"
        (folder / name).write_text(text)
        (folder / "own.toml").write_text(study)
        return name

    return write


def test_a_function_becomes_a_machine_with_units_bounds_lives_and_arrays(uq, write):
    file = write(WEAR)
    assert uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet").err == ""
    ds = package.open_result("own.nc")
    load = ds["load"].values
    assert "ValueError: too heavy" in ds["status"].attrs["example_raised"]
    heavy = load > 1.9
    assert (ds["status"].values == np.where(heavy, Status.RAISED, Status.OK)).all() and heavy.any()
    known = ~heavy
    expected = np.where(load < 0.1, np.inf, np.where(load < 0.2, 20.0, 3.0 / load))
    assert (ds["life"].values[known] == expected[known]).all()
    cut = (load >= 0.1) & (load < 0.2)
    assert (ds["life_censored"].values[known] == cut[known]).all() and cut.any()
    assert (ds["profile"].values[known] == np.stack([load, 2 * load], axis=1)[known]).all()
    assert ds["load"].attrs["units"] == "N" and ds["load"].attrs["long_name"] == "force on the pad"


def test_rows_are_equal_to_the_bit_in_processes_of_their_own(uq, write):
    file = write(WEAR)
    uq("run", "own.toml", "--model", file, "-o", "here.nc", "--quiet", "--workers", "0")
    uq("run", "own.toml", "--model", file, "-o", "there.nc", "--quiet", "--workers", "2")
    assert package.open_result("here.nc").equals(package.open_result("there.nc"))
    assert "equal to the bit" in uq("verify", "there.nc", "--model", file).out


def test_a_life_that_ends_in_all_rows_seen_is_named_when_one_does_not(uq, write):
    study = STUDY.replace("samples = 100", "samples = 1000").replace("lower = 0.0", "lower = 0.2")
    file = write(WEAR.replace("load < 0.1", "0.900 < load < 0.903"), study)
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet")
    ds = package.open_result("own.nc")
    lost = ds["status"].values == Status.BAD_SHAPE
    assert lost.any() and not lost[:64].any()
    assert "returns={'life': uq.Returned(life=True)}" in ds["status"].attrs["example_bad_shape"]


def test_a_long_array_is_described_at_some_places_unless_it_is_named(uq, write, monkeypatch):
    monkeypatch.setattr(elements, "MOST_PLACES", 12)
    text = (
        "import uq\n@uq.machine\ndef wear(load=1.0): return {'y': [[load] * 3] * 90, 'z': load}\n"
    )
    file, study = write(text), STUDY.replace("100", "20")
    for more, count in (("", 3 * 4), ("[analysis]\noutputs = ['y']\n", 3 * 90)):
        file = write(text, study + more)
        uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet", "--fresh")
        ds = package.open_result("own.nc")
        found = [one.name for one in elements.elements_of(ds, ["y"])]
        assert len(found) == count and found[0] == "y[y_0=0,y_1=0]"
        assert found[-1] == "y[y_0=89,y_1=2]" and len(elements.named_elements(ds, "y")) == 270
        (one,) = elements.named_elements(ds, "y[y_0=17,y_1=1]")
        assert one.place == {"y_0": 17, "y_1": 1}
        said = "y: shown at evenly spread places, as it has 270 elements"
        assert [one[: len(said)] for one in elements.notes_on_places(ds)] == [said] * (not more)


def test_what_is_declared_is_not_looked_for(uq, write):
    text = WEAR.replace(
        "@uq.machine", '@uq.machine(returns={"life": uq.Returned("s", life=True), "profile": "m"})'
    )
    ended = uq("check", "own.toml", "--model", write(text))
    assert ended.code == 0
    uq("run", "own.toml", "--model", write(text), "-o", "own.nc", "--quiet")
    ds = package.open_result("own.nc")
    assert ds["life"].attrs["units"] == "s"
    said = ds["status"].attrs["example_bad_shape"]
    assert "returned 'profile' with shape (2,), expected ()" in said


@pytest.mark.parametrize(("unit", "fits"), [("m", True), ("mm", False), ("MPa", False)])
def test_a_threshold_has_the_unit_of_its_output_or_of_its_base(uq, write, unit, fits):
    text = f"import uq\n@uq.machine(returns={{'y': '{unit}'}})\ndef wear(load=1.0): ...\n"
    study = STUDY + "[analysis]\nthresholds = {y = '250 um'}\n"
    ended = uq("check", "own.toml", "--model", write(text, study))
    assert (ended.code == 0) is fits
    if not fits:
        assert f"'y' is in '{unit}': give the number in that unit, without a unit" in ended.err


def test_a_threshold_with_a_unit_waits_for_the_outputs(uq, write):
    limits = '[analysis]\nthresholds = {life = "4 days"}\n'
    refused = uq("check", "own.toml", "--model", write(WEAR, STUDY + limits))
    assert refused.code == 2 and "the unit 'days' does not fit 'life'" in refused.err
    in_seconds = '@uq.machine(returns={"life": uq.Returned("s", life=True), "profile": "m"})'
    text = WEAR.replace("@uq.machine", in_seconds)
    assert uq("check", "own.toml", "--model", write(text, STUDY + limits)).code == 0


def test_a_life_is_counted_in_its_own_unit(uq, write):
    text = WEAR.replace(
        "@uq.machine",
        '@uq.machine(returns={"life": uq.Returned("cycles", life=True), "profile": uq.Returned('
        "shape=(2,))})",
    )
    uq("run", "own.toml", "--model", write(text), "-o", "own.nc", "--quiet", "--samples", "40")
    ds = package.open_result("own.nc")
    assert package.survival(ds, "life")["time"].attrs["units"] == "cycles"
    ended = uq("fleet", "own.nc", "--size", "1", "--by", "2")
    assert "life [cycles]" in ended.out and "by 2 cycles" in ended.out
    assert "the unit 'h' does not fit" in uq("fleet", "own.nc", "--size", "1", "--by", "2 h").err


SCALED = """
import math
import uq

@uq.machine(returns={"life": uq.Returned("s", life=True, scales={"load": -1.0, "depth": 2.0})})
def wear(load: float = 1.0, depth: float = 3.0, hard: float = 1.0):
    if hard > 1.5:
        return {"life": math.inf}
    life = hard * depth**2 / load
    return {"life": life if life < 20.0 else uq.censored(20.0)}
"""
SCALES_STUDY = (
    STUDY.replace("lower = 0.0", "lower = 1.0")
    + """
[uncertain.hard]
distribution = "uniform"
lower = 0.2
upper = 0.9
source = "assumed"
[analysis]
thresholds = {life = 4.0}
"""
)


def test_what_only_scales_a_life_is_integrated(uq, write):
    file = write(SCALED, SCALES_STUDY)
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet")
    assert "load integrated exactly, worth" in uq("summary", "own.nc").out
    ds = package.open_result("own.nc")
    by = summarised(ds)["outputs"]["life"]["thresholds"]["4.0"]["below"]["value"]
    hard = ds["hard"].values
    assert by == pytest.approx((2.0 - 9.0 * hard / 4.0).clip(0, 1).mean(), rel=1e-12)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (("/ load", "/ (load + 1e-6)"), "'life' does not scale as declared: at load = "),
        (("hard > 1.5", "load > 1.5"), "not inf|it is inf, not"),
        (("/ load", "/ min(load, 1.9)"), "'life' does not scale as declared: at load = 2"),
        (("/ load", "/ (load if hard < 0.85 else 1.0)"), "'life' does not scale as declared"),
        (("/ load", "/ (load if hard > 0.25 else 1.0)"), "'life' does not scale as declared"),
        (("censored(20.0)", "censored(1e9)"), "it is 1e+09, not"),
        (('"depth": 2.0', '"dept": 2.0'), "scales: no such parameter; did you mean 'depth'?"),
        (('"depth": 2.0', '"depth": 0.0'), "depth = 0.0 must be a number but 0"),
        (("life=True, ", ""), "only a life has scales"),
        (("depth: float = 3.0", "depth: float = -3.0"), "value of 'depth' must be positive"),
    ],
)
def test_a_life_that_does_not_scale_as_declared_is_refused(uq, write, wrong, said):
    file = write(SCALED.replace(*wrong), SCALES_STUDY)
    for verb in (("check", "own.toml"), ("run", "own.toml", "-o", "own.nc", "--quiet")):
        ended = uq(*verb, "--model", file)
        assert ended.code == 2 and any(one in ended.err for one in said.split("|")), ended.err


def test_a_seed_is_that_of_the_row(uq, write):
    file = write(
        "import uq\n@uq.machine\n"
        "def wear(seed, load: float = 1.0):\n    return {'y': load + seed % 7}\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet")
    noise = package.open_result("own.nc")
    assert len(np.unique(np.round(noise["y"].values - noise["load"].values))) == 7
    assert noise.attrs["random"] == 1


BOUNDED = (
    "from typing import Annotated\nimport uq\n"
    "@uq.machine\ndef wear(load: Annotated[float, %s] = 1.0): ...\n"
)

MISTAKES = {
    "x = 1\n": "has no model and no function under @uq.machine",
    "def wear(load=1.0): return {}\n": "has no model and no function under @uq.machine",
    "import uq\n@uq.machine\ndef a(x=1.0): ...\n@uq.machine\ndef b(x=1.0): ...\n": "name one, ",
    "import uq\n@uq.machine\ndef wear(load): return {}\n": "its nominal value is needed",
    "import uq\n@uq.machine\ndef wear(*load): return {}\n": "only named floats can be parameters",
    "import uq\n@uq.machine\ndef wear(): return {}\n": "has no arguments",
    "import uq\n@uq.machine\ndef wear(load=1.0): return load\n": "returned float, not a dict",
    "import uq\n@uq.machine\ndef wear(load=1.0): return {'y': 'a'}\n": "returned 'y' as str",
    "import uq\n@uq.machine\ndef wear(load=1.0): 1 / 0\n": "raised ZeroDivisionError",
    "import os, uq\n@uq.machine\ndef wear(load=1.0): os._exit(3)\n": "killed its process",
    "import uq\n@uq.machine(returns={'y': 3})\ndef wear(load=1.0): ...\n": "must be a unit or",
    "import uq\n@uq.machine(returns={})\ndef wear(load=1.0): ...\n": "name at least one output",
    "import uq\nuq.machine(\n": "SyntaxError",
    "import uq\n@uq.machine\ndef wear(load=1.0, /): ...\n": "only named floats can be parameters",
    "import uq\nwear = uq.machine(lambda load=1.0: {})\n": "is not a function with a name",
    "import uq\n@uq.machine\nclass Wear: ...\n": "is not a function with a name",
    "import uq\n@uq.machine\ndef wear(load=float('nan')): ...\n": "nominal value nan of 'load'",
    "import uq\n@uq.machine\ndef wear(load=float('inf')): ...\n": "nominal value inf of 'load'",
    BOUNDED % "(2.0, 3.0)": "nominal value 1 of 'load' must be a finite number between 2 and 3",
    BOUNDED % "(3.0, 0.0)": "bounds of 'load' must be a lower and a higher number, not (3, 0)",
    BOUNDED % "(0.0, None)": "annotation (0.0, None): a unit, a pair of bounds or a meaning",
    "import uq\n@uq.machine\ndef wear(world=1.0): ...\n": (
        "parameter 'world' is the name of one of a result's own variables"
    ),
    "import uq\n@uq.machine\ndef wear(load=1.0): raise ValueError('x' * 9999)\n": "xxx ...",
    BOUNDED % "'newtons per metre!'": "unit 'newtons per metre!' of 'load': write its factors with",
    "import uq\n@uq.machine(returns={'y': 'hours'})\ndef wear(load=1.0): ...\n": (
        "unit 'hours' of output 'y': write it as 'h'"
    ),
    "import uq\n@uq.machine\ndef wear(load: 'no such' = 1.0): ...\n": "annotations: ",
    "import uq\n@uq.machine\ndef wear(load=1.0): return {}\n": "returned an empty dict",
    "import uq\n@uq.machine\ndef wear(load=1.0): return {'load': load}\n": (
        "output 'load': 'load' is the name of a parameter; choose another"
    ),
    "import uq\n@uq.machine\ndef wear(load=1.0): return {'status': load}\n": (
        "'status' is the name of one of a result's own variables"
    ),
    "import uq\n@uq.machine\ndef wear(load=1.0): return {'y': [load], 'y_index': 0.0}\n": (
        "'y_index' is the name of output 'y' or of a part of it"
    ),
    "from . import other\n": "ImportError: attempted relative import",
    "import sys, uq\n@uq.machine\ndef wear(load=1.0): sys.exit(3)\n": "raised SystemExit: 3",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_mistake_in_the_file_is_one_line(uq, write, text):
    ended = uq("check", "own.toml", "--model", write(text))
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.count("\n") == 1 and MISTAKES[text] in ended.err


def test_a_file_that_is_not_there_or_has_the_name_of_another_module_is_one_line(uq, write, folder):
    file = write(WEAR)
    assert f"no such file; did you mean '{file}'?" in uq("models", file.replace("own", "owm")).err
    (folder / "random.py").write_text(WEAR)
    assert "rename the file" in uq("models", "random.py").err


def test_a_study_names_no_code(uq, write):
    file = write(WEAR, STUDY.replace('"wear"', '"own_machine.py"'))
    assert file and "must consist of letters" in uq("check", "own.toml").err


@pytest.mark.parametrize("workers", [0, 2])
def test_a_row_that_leaves_the_program_or_its_folder_costs_that_row_only(uq, write, workers):
    file = write(
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


def test_a_function_that_remembers_its_rows_is_noticed(uq, write):
    file = write(
        "import uq\nrows = []\n@uq.machine\ndef wear(load: float = 1.0):\n"
        "    rows.append(load)\n    return {'y': load + len(rows)}\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet", "--samples", 40)
    ended = uq("verify", "own.nc", "--model", file)
    assert ended.code == 1 and "does not return the same" in ended.out
    reason = uq("row", "own.nc", 30, "--model", file).out
    assert "the model does not return the same" in " ".join(reason.split())


def test_an_own_model_that_is_not_named_is_asked_for(uq, write):
    write(WEAR)
    assert "a model of your own is named by its file" in uq("check", "own.toml").err


SLOW_TO_LEARN = """
import time, uq
@uq.machine
def wear(load: float = {nominal}):
    if load > 1.5:
        time.sleep(300)
    return {{"y": load}}
"""


@pytest.mark.slow
def test_a_nominal_row_that_hangs_is_one_line(uq, write, monkeypatch):
    monkeypatch.setattr(loading, "FIRST_SECONDS", 0.0)
    monkeypatch.setattr(loading, "_SLOW", 0.5)
    file = write(SLOW_TO_LEARN.format(nominal=2.0))
    ended = uq("run", "own.toml", "--model", file, "--row-limit", "1")
    told, refused = ended.err.splitlines()
    assert told.startswith("running 65 rows, once, to see what the model returns; 'returns' in")
    assert ended.code == 2 and refused.endswith("its nominal row did not end within 1 s")


@pytest.mark.slow
def test_a_row_that_hangs_while_it_is_seen_what_is_returned_costs_that_row_only(
    uq, write, monkeypatch
):
    monkeypatch.setattr(loading, "FIRST_SECONDS", 0.0)
    monkeypatch.setattr(child, "FIRST_SECONDS", 0.5)
    file = write(SLOW_TO_LEARN.format(nominal=1.0))
    ended = uq("run", "own.toml", "--model", file, "--row-limit", "0.5", "--samples", "6")
    ds = package.open_result("results/own.nc")
    slow = ds["load"].values > 1.5
    assert (ds["status"].values == np.where(slow, Status.TIMED_OUT, Status.OK)).all() and slow.any()
    assert "Traceback" not in ended.err


def test_a_row_that_ends_its_process_is_one_sentence_of_simulate(uq, write):
    file = write(
        "import ctypes, uq\n@uq.machine(returns={'y': '1'})\ndef wear(load: float = 1.0):\n"
        "    ctypes.string_at(0)\n    return {'y': load}\n"
    )
    ended = uq("simulate", file)
    assert ended.code == 1 and ended.err == ""
    assert ended.out.startswith("wear: crashed  killed its process (Segmentation fault)\n")


@pytest.mark.slow
def test_slow_rows_of_two_workers_begin_together(uq, write):
    file = write(
        "import time, uq\n@uq.machine(returns={'began': 's'})\ndef wear(load: float = 1.0):\n"
        "    began = time.time()\n    time.sleep(3)\n    return {'began': began}\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--workers", "2", "--samples", "2")
    first, second = package.open_result("own.nc")["began"].values
    assert abs(second - first) < 3


@pytest.mark.slow
def test_simulate_shows_what_a_function_prints(write):
    file = write(
        "import uq\n@uq.machine(returns={'y': '1'})\ndef wear(load: float = 1.0):\n"
        "    print('here I am')\n    return {'y': load}\n"
    )
    command = [sys.executable, "-m", "uq", "simulate", file, "--json"]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.stderr == "here I am\n" and json.loads(ended.stdout)["outputs"] == {"y": 1.0}


def test_a_compiled_function_returns_a_tuple(uq, write):
    file = write(
        "from math import inf\nimport numba\nimport uq\n"
        '@uq.machine(returns={"life": uq.Returned("s", life=True), "energy": "J"})\n'
        "@numba.njit\ndef wear(load=1.0, depth=3.0):\n"
        "    return (depth / load if load > 0.1 else inf), load**2\n"
    )
    uq("run", "own.toml", "--model", file, "-o", "own.nc", "--quiet")
    ds = package.open_result("own.nc")
    load = ds["load"].values
    assert (ds["energy"].values == load**2).all()
    assert (ds["life"].values == np.where(load > 0.1, 3.0 / load, np.inf)).all()


HARD = """
from math import inf, nan
import numba
import numpy as np
import uq

@uq.machine(returns={
    "life": uq.Returned("s", life=True), "curve": uq.Returned(shape=(3,)), "noise": "1"
})
@numba.njit
def wear(seed, load=1.0):
    if load > 1.6:
        raise ValueError("too heavy")
    many = np.exp(load * np.arange(2 if 1.5 < load else 3))
    life = nan if 1.4 < load < 1.5 else 3.0 / load if load > 0.1 else inf
    return life, many, inf if 1.3 < load < 1.4 else load + seed % 7
"""


@pytest.mark.slow
def test_a_compiled_loop_over_rows_returns_what_each_row_returns(write):
    batch = find_model(write(HARD)).batch
    assert isinstance(batch, Compiled)
    chance = np.random.default_rng(1)
    x, seed = 2 * chance.random((500, 1)), chance.integers(0, 2**64 - 1, 500, dtype=np.uint64)
    found = batch(x, seed, None)
    again = batch(x[123:], seed[123:], None)
    one_by_one = RowByRow.__call__(batch, x, seed, None)
    for name, values in found[0].items():
        assert values.tobytes() == one_by_one[0][name].tobytes()
        assert values[123:].tobytes() == again[0][name].tobytes()
    assert (found[1] == one_by_one[1]).all() and found[2] == one_by_one[2]
    kinds = {Status.OK, Status.RAISED, Status.NON_FINITE, Status.BAD_SHAPE}
    assert set(found[1].tolist()) == kinds
    assert "ValueError: too heavy" in found[2].values()


def test_a_new_machine_passes_as_it_is_written(uq, folder):
    name = f"new_machine_{next(_numbers)}"
    ended = uq("init", "--machine", name)
    assert ended.code == 0 and (folder / name / "README.md").is_file()
    file, study = (f"{name}/{name}.{ending}" for ending in ("py", "toml"))
    assert uq("check", study, "--model", file).code == 0
    assert "150 days" in uq("run", study, "--model", file, "-o", "own.nc").out
    tests = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider"]
    assert subprocess.run(tests, cwd=folder / name, stdout=subprocess.DEVNULL).returncode == 0
    assert "exists already" in uq("init", "--machine", name).err
    assert "another module" in uq("init", "--machine", "random").err
