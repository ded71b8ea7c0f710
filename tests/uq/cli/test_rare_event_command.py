"""Rare events: the command, and what is refused."""

import json
import sys

import numpy as np
import pytest
from computed import UNIFORM
from rare_studies import LAST, linear, study

from uq.errors import InputError
from uq.explore.rare_events import rare_event


def test_the_command_shows_and_writes_json(uq, write_study):
    path = write_study("linear", uncertain=("x1", "x2", "x3", "x4"), law='distribution="uniform",'
                       "lower=0.0, upper=1.0")  # fmt: skip
    options = ("--output", "y", "--above", "9.5", "--samples", 200)
    ended = uq("rare-event", path, *options)
    assert ended.code == 0 and "95 % interval" in ended.out
    assert ended.out.startswith("P(y > 9.5)")
    document = json.loads(uq("rare-event", path, *options, "--json").out)
    low, value, high = (document["probability"][key] for key in ("low", "value", "high"))
    assert low < value < high
    assert low <= 0.5**4 / 576 <= high
    assert list(document["typical"]) == ["x1", "x2", "x3", "x4"]
    point = json.loads(uq("rare-event", path, *options, "--method", "importance", "--json").out)
    assert point["design_points"][0]["location"]["x4"] > 0.9
    assert uq("rare-event", path, "--output", "y").err.startswith("uq: give one of")


def test_several_limits_are_options(uq, write_study):
    path = write_study("linear", uncertain=("x1", "x2", "x3", "x4"), law='distribution="uniform",'
                       "lower=0.0, upper=1.0")  # fmt: skip
    options = ("--samples", 200, "--workers", 0)
    ended = uq("rare-event", path, "--any", "y > 9.5", "--any", "y<0.5", *options)
    assert ended.code == 0 and ended.out.startswith("P(y > 9.5 or y < 0.5)")
    limits = ("--all", "y > 9", "--all", "y < 9.5")
    document = json.loads(uq("rare-event", path, *limits, *options, "--json").out)
    assert document["combination"] == "all" and document["side"] == ["above", "below"]
    low, high = (document["probability"][key] for key in ("low", "high"))
    assert low < (1 - 0.5**4) / 576 < high
    for mistake, words in (
        (("--any", "y > 9", "--all", "y < 9.5"), "uq: give one of --any and --all"),
        (("--any", "y is 9", "--any", "y < 9.5"), "uq: --any 'y is 9' is not a limit"),
        (("--any", "y > 9"), 'uq: give --any at least twice, such as --any "a > 3" --any "b < 1"'),
        (("--all", "y > 9"), 'uq: give --all at least twice, such as --all "a > 3" --all "b < 1"'),
        (("--any", "y > 9", "--any", "y < 1", "--output", "y"), "uq: give --output with --above"),
        (("--above", "9"), "uq: give an --output, or limits"),
    ):
        ended = uq("rare-event", path, *mistake)
        assert ended.code == 2 and ended.err.startswith(words) and ended.err.count("\n") == 1


def test_active_learning_shows_what_its_rows_contradict(uq, write_study):
    path = write_study("linear", uncertain=("x1", "x2", "x3", "x4"), law='distribution="uniform",'
                       "lower=0.0, upper=1.0")  # fmt: skip
    options = ("--output", "y", "--above", "9.5", "--method", "active", "--samples", 150)
    ended = uq("rare-event", path, *options, "--workers", 0)
    assert ended.code == 0 and "by active" in ended.out and "rows           150" in ended.out
    assert "of the last 50 rows contradict the emulator" in " ".join(ended.out.split())
    document = json.loads(uq("rare-event", path, *options, "--workers", 0, "--json").out)
    assert document["rows"] == 150 and document["checks"] == 50 and document["hidden_high"] < 1
    low, high = (document["probability"][key] for key in ("low", "high"))
    assert low <= 0.5**4 / 576 <= high


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"output": "z"}, "no such output"),
        ({"threshold": np.nan}, "threshold must be finite"),
        ({"method": "subsett"}, "did you mean 'subset'"),
        ({"samples": 99}, "samples must be at least 100: 99"),
        ({"replicates": 0}, "replicates must be at least 1: 0"),
        ({"workers": -1}, "workers must not be negative"),
    ],
)
def test_mistakes_are_said_in_a_line(arguments, words):
    with pytest.raises(InputError, match=words):
        rare_event(**({"study": linear(), "output": "y", "threshold": 9.0} | arguments))


def test_an_element_must_be_named():
    of = study("sample_models:KINDS", {"x1": UNIFORM, "x2": UNIFORM})
    for name, words in (
        ("life", r"choose one, such as 'life\[side=left,depth=0.5\]'"),
        ("life[side=left]", "no such element"),
        ("regime", "is a category"),
    ):
        with pytest.raises(InputError, match=words):
            rare_event(of, name, 1.0)


def test_without_openturns_there_is_a_sentence(monkeypatch):
    monkeypatch.setitem(sys.modules, "openturns", None)
    with pytest.raises(InputError, match=r"pip install 'vibrolife\[reliability\]'"):
        rare_event(linear(), "y", LAST, method="importance")
    assert float(rare_event(linear(), "y", 5.0)["probability"]) > 0.4
