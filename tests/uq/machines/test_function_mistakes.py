"""A plain function as a machine: what is wrong with its file is one line."""

import os

import pytest
from own_machines import WEAR, WEAR_STUDY

from uq.machines.returned import Returned, RowError, checked

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
    "import uq\n@uq.machine(returns=['y'])\ndef wear(load=1.0): ...\n": "must be a dict of outputs",
    "import uq\n@uq.machine(returns={'y': uq.Returned(shape=3)})\ndef wear(load=1.0): ...\n": (
        "shape of 'y' must be a tuple of numbers above 0, not 3"
    ),
    "import uq\n@uq.machine(returns={'y': uq.Returned(3)})\ndef wear(load=1.0): ...\n": (
        "unit and meaning of 'y' must be text"
    ),
    "import uq\n@uq.machine\ndef wear(load=1.0): input('how? ')\n": "raised EOFError",
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
    "import uq\n@uq.machine\nasync def wear(load=1.0): ...\n": (
        "machine 'wear': is written with 'async def'; write it with 'def'"
    ),
    "import uq\n@uq.machine\ndef wear(load=1.0): yield {'y': load}\n": (
        "machine 'wear': has a 'yield'; it must return its outputs"
    ),
    "import uq\n@uq.machine\ndef wear(load=1.0): return {'y': []}\n": (
        "returned 'y' as an empty array"
    ),
    "import uq\n@uq.machine\ndef wear(load=1.0): return {'y': 10**400}\n": (
        "returned 'y' with an integer too large for a float"
    ),
    "from . import other\n": "ImportError: attempted relative import",
    "import sys, uq\n@uq.machine\ndef wear(load=1.0): sys.exit(3)\n": "raised SystemExit: 3",
}


@pytest.mark.parametrize("text", MISTAKES)
def test_a_mistake_in_the_file_is_one_line(uq, write_function, text):
    ended = uq("check", "own.toml", "--model", write_function(text))
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.count("\n") == 1 and MISTAKES[text] in ended.err


def test_a_file_that_is_not_there_or_has_the_name_of_another_module_is_one_line(
    uq, write_function, folder
):
    file = write_function(WEAR)
    assert f"no such file; did you mean '{file}'?" in uq("models", file.replace("own", "owm")).err
    (folder / "random.py").write_text(WEAR)
    assert "rename the file" in uq("models", "random.py").err


def test_a_study_names_no_code(uq, write_function):
    file = write_function(WEAR, WEAR_STUDY.replace('"wear"', '"own_machine.py"'))
    assert file and "must consist of letters" in uq("check", "own.toml").err


def test_an_own_model_that_is_not_named_is_asked_for(uq, folder, write_function):
    file = write_function(WEAR)
    assert f"{file} defines it; add --model {file}" in uq("check", "own.toml").err
    (folder / file).unlink()
    assert "a model of your own is named by its file" in uq("check", "own.toml").err


def test_an_output_that_is_missing_is_named_with_what_was_returned_instead():
    with pytest.raises(RowError) as caught:
        list(checked({"strees": 1.0, "mass": 2.0}, {"stress": Returned()}))
    assert str(caught.value) == (
        "returned no 'stress' (it returned 'strees', 'mass'); did you mean 'strees'?"
    )


KILLS_ITS_IMPORTER = """
import os
import uq

if os.getpid() != {here}:
    with open({tries!r}, "a") as file:
        file.write("tried\\n")
    os._exit(3)

@uq.machine
def wear(load=1.0):
    return {{"life": load}}
"""


def test_an_import_that_kills_the_process_is_tried_once(uq, write_function, folder):
    tries = folder / "tries"
    ended = uq(
        "check",
        "own.toml",
        "--model",
        write_function(KILLS_ITS_IMPORTER.format(here=os.getpid(), tries=str(tries))),
    )
    assert (ended.code, ended.out) == (1, "")
    assert ended.err.count("\n") == 1 and "could not start: exit code 3" in ended.err
    assert tries.read_text().splitlines() == ["tried"]
