"""A file from a stranger is data: it runs nothing, writes nothing elsewhere, and says its piece."""

import json
import os
import re
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr

from uq.errors import InputError
from uq.execution import runner
from uq.result.result_file import open_result
from uq.text.literals import plain, plain_line

READERS = ("summary", "sensitivity", "plot", "status", "verify")
ESCAPE = "\x1b[31mred\x1b[0m\x07\x9b2J\u202e[bold]x[/bold]"


@pytest.fixture
def result(write_study, folder):
    path = write_study(method="saltelli", replicates=2, samples=16)
    runner.run(path, "out.nc", workers=0)
    return folder / "out.nc"


def refused(ended):
    return ended.code == 2 and ended.err.count("\n") == 1 and not ended.out


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('model = "ishigami"', 'model = "os:system"'), 'model = "os:system"'),
        (('name = "small"', 'name = "../../elsewhere"'), 'name = "../../elsewhere"'),
        (('name = "small"', f'name = "{"x" * 1000}"'), "at most 100 characters"),
        (("samples = 64", "samples = 1000000000000"), "must be at most"),
        (("samples = 64", "samples = 1000000000"), "MB left"),
        (("samples = 64", f"samples = {'9' * 5000}"), "small.toml: "),
        (("[study]", "[study]\nx = " + "[" * 5000), "not valid TOML"),
        (("[study]", "[study]\n\x00"), "not valid TOML"),
        (("[study]", f"[study]\n{'x.' * 20_000}y = 1"), "key of more than 64 parts (at line 2)"),
        (("[study]", f'[study]\nx = {{{"a . " * 20_000}"y" = 1}}'), "not valid TOML: a key of"),
        (("[uncertain]", '[uncertain]\n"\\u001b[31m\\n\\u202e" = 1'), r"\u001b[31m"),
        (("[study]", "[study]\n#" + "x" * 1_000_001), "a study is at most 1 MB long"),
    ],
)
def test_a_hostile_study_is_refused_in_one_line(uq, write_study, folder, change, words):
    path = write_study()
    path.write_text(path.read_text().replace(*change))
    ended = uq("run", path)
    assert (ended.code, ended.out) == (2, "")
    assert all(line.startswith((str(path), "results")) for line in ended.err.splitlines())
    assert words in ended.err
    assert "\x1b" not in ended.err and "\u202e" not in ended.err
    assert [entry.name for entry in folder.iterdir()] == ["small.toml"]


def test_an_endless_study_file_is_refused(uq):
    assert refused(uq("check", "/dev/zero"))


def test_texts_from_a_file_do_nothing_to_the_terminal(uq, write_study, folder):
    path = write_study(method="morris", samples=8, replicates=2)
    text = json.dumps(ESCAPE)
    path.write_text(path.read_text().replace("[study]", f"[study]\ndescription = {text}"))
    shown = ("check", path), ("summary", "out.nc", "--full")
    for verb in (("run", path, "-o", "out.nc"), ("summary", "out.nc"), *shown):
        ended = uq(*verb)
        assert ended.code == 0
        assert not set("\x1b\x07\x9b\u202e") & set(ended.out + ended.err)
        if verb not in shown:  # a card does not show the description
            continue
        assert r"\u001b[31mred" in ended.out
        assert "[bold]x[/bold]" in ended.out
    assert uq("plot", "out.nc").code == 0


@pytest.mark.parametrize(
    "verbs", ["summary status".split(), pytest.param(READERS, marks=pytest.mark.slow)]
)
def test_texts_of_a_result_do_nothing_to_the_terminal(uq, result, verbs):
    with netCDF4.Dataset(result, "a") as file:
        file["y"].long_name = ESCAPE + "$\\frac{"
        file["x1"].long_name = ESCAPE + "$\\frac{"
        file["status"].example_raised = ESCAPE
        file.title = ESCAPE
        file.source = ESCAPE
    for verb in verbs:
        ended = uq(verb, result)
        assert ended.code in (0, 1)  # its checksum no longer holds
        assert not set("\x1b\x07\x9b\u202e") & set(ended.out + ended.err)
        assert "Traceback" not in ended.err


@pytest.mark.parametrize("verb", ["summary", "what-if", "twin", "verify"])
def test_a_broken_study_in_a_result_is_one_line(uq, result, verb):
    with netCDF4.Dataset(result, "a") as file:
        file.study = file.study.replace("lower", "lowr").replace("saltelli", "salteli")
    ended = uq(verb, result, *["--set", "uncertain.x1.upper=2"] * (verb == "what-if"))
    assert ended.code == 2
    assert re.search(r"\[design\] method.*'saltelli'.*; and \d+ more$", ended.err.splitlines()[-1])
    assert "lowr" not in ended.err


def test_a_truncated_result_is_refused_in_one_line(uq, result):
    whole = result.read_bytes()
    for length in (0, 1, 8, 100, 1000, len(whole) // 2, len(whole) - 1):
        result.write_bytes(whole[:length])
        for verb in ("summary", "plot"):
            assert refused(uq(verb, result)), (length, verb)


def spoilt(ds):
    """Yield the dataset with one thing wrong, and what it is."""
    for name in ("title", "study", "design", "samples", "replicates", "source", "study_identity"):
        attrs = {key: value for key, value in ds.attrs.items() if key != name}
        yield f"no {name}", ds.drop_attrs(deep=False).assign_attrs(attrs)
        yield f"odd {name}", ds.assign_attrs({name: np.array([1.5, 2.5])})
    for name in ("status", "replicate", "group", "block"):
        yield f"no {name}", ds.drop_vars(name)
        yield f"{name} of floats", ds.assign({name: ds[name].astype(float)})
    for name, attribute in [
        ("y", "kind"),
        ("y", "units"),
        ("y", "long_name"),
        ("y", "may_be_undefined"),
        ("x1", "long_name"),
        ("status", "flag_values"),
        ("status", "flag_meanings"),
        ("block", "flag_meanings"),
    ]:
        other = ds.copy()
        attrs = {key: value for key, value in ds[name].attrs.items() if key != attribute}
        other[name].attrs = attrs
        yield f"no {attribute} of {name}", other
    for name in ("status", "block"):
        other = ds.copy()
        other[name].attrs = ds[name].attrs | {"flag_meanings": "one too many for it " * 3}
        yield f"too many meanings of {name}", other
    yield "study that is none", ds.assign_attrs(study="[study")
    yield "values of text", ds.assign(y=("row", ds["y"].values.astype(str), ds["y"].attrs))
    yield "values without rows", ds.assign(y=((), 1.0, ds["y"].attrs))


@pytest.mark.parametrize(
    "verb", ["summary", *(pytest.param(verb, marks=pytest.mark.slow) for verb in READERS[1:3])]
)
def test_a_malformed_result_is_refused_in_one_line(uq, result, folder, verb):
    with xr.open_dataset(result) as opened:
        ds = opened.load()
    for fault, other in spoilt(ds):
        other.to_netcdf("other.nc")
        ended = uq(verb, "other.nc")
        assert refused(ended), (fault, ended)


def test_a_result_that_claims_to_be_enormous_is_refused(uq, result):
    with netCDF4.Dataset(result, "a") as file:
        file.createDimension("much", 10**12)
        file.createVariable("z", "f8", ("much",), chunksizes=(10**6,))
    with pytest.raises(InputError, match="MB claim to be 4e\\+03 GB"):
        open_result(result)
    assert refused(uq("summary", result))


def test_nothing_in_the_platform_unpickles_or_evaluates_a_file():
    for path in (Path(__file__).parents[2] / "uq").rglob("*.py"):
        text = path.read_text()
        for word in ("import pickle", "marshal", " eval(", "exec(", "yaml", "allow_pickle=True"):
            assert word not in text, f"{path}: {word}"


def test_plain_texts_stay_and_others_are_shown():
    assert plain("Größe 1 µm\n[x]") == "Größe 1 µm\n[x]"
    assert plain("\x1b\x00\x7f\x9b\u202e") == r"\u001b\u0000\u007f\u009b\u202e"
    assert plain_line("a\nb\r") == "a\\nb\\u000d"
    assert os.sep in plain(f"a{os.sep}b")
