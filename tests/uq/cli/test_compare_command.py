"""The comparison on the command line: what it prints and refuses."""

import json
from pathlib import Path

import numpy as np
import pytest
from compared_studies import FOUR, NARROW, study
from computed import (
    asking,
    compared,
    kinds,
    linear,
    with_output,
)
from wordings import sentence

from uq.errors import InputError
from uq.files.whole_files import write_result


def test_studies_that_cannot_be_compared_are_refused_in_a_line(uq, folder):
    morris = linear("morris", samples=8, replicates=2)
    for name, ds in (("a", linear()), ("k", kinds()), ("m", morris)):
        write_result(ds, folder / f"{name}.nc")
    for pair, line in (
        (("a.nc", "k.nc"), "model 'linear', the second of 'kinds': only studies of the same model"),
        (("a.nc", "m.nc"), "the second, a 'morris' design, do not follow the laws"),
        (("a.nc", "none.nc"), sentence("no file", name="none.nc")),
    ):
        ended = uq("compare", *pair)
        assert (ended.code, ended.out, ended.err.count("\n")) == (2, "", 1)
        assert line in ended.err
    with pytest.raises(InputError, match="no output in common"):
        compared(linear(), linear().rename(y="z"))


def test_compare_on_the_command_line(uq, folder):
    write_result(study(FOUR), folder / "a.nc")
    write_result(study(FOUR | {"x4": NARROW}), folder / "b.nc")
    ended = uq("compare", "a.nc", "b.nc")
    words = " ".join(ended.out.split())
    assert ended.code == 0 and ended.err == ""
    for line in (
        "A a.nc one (200 rows)",
        "x4 A uniform(lower = 0.0, upper = 1.0) B uniform(lower = 0.3, upper = 0.7)",
        "Only x4 differs (sd 0.2",
        "less variance",
        "rows with the same number are paired",
    ):
        assert line in words, line
    assert max(map(len, ended.out.splitlines())) <= 80
    document = json.loads(uq("compare", "a.nc", "b.nc", "--json").out)
    assert document["a"]["file"] == "a.nc" and document["pairing"] == "rows"
    assert set(document["outputs"]["y"]["sd"]) == {"a", "b", "difference", "ratio"}
    assert "\nnone" in "\n".join(map(str.strip, uq("compare", "a.nc", "a.nc").out.splitlines()))


def test_times_are_given_in_a_unit_people_use(uq, folder):
    for name, factor in (("a", 1.0), ("b", 2.0)):
        values = factor * 86400.0 * np.linspace(5, 15, 64)
        ds = asking(with_output(linear(), "life", values, "lifetime"), outputs=["life"])
        write_result(ds, Path(f"{name}.nc").absolute())
    out = uq("compare", "a.nc", "b.nc").out
    assert "life [days]" in out
    assert next(line.split()[1:4] for line in out.splitlines() if "mean" in line) == [
        "10",
        "20",
        "10",
    ]
