"""Results written in schema version 1 are read by every verb as before."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import uq as api

KEPT = Path(__file__).parents[2] / "support" / "version_1"
KINDS = ("plain", "units", "posterior")
VERBS = [
    *((kind, verb) for kind in KINDS for verb in ("status", "summary", "report", "plot")),
    ("plain", "sensitivity"),
    ("plain", "convergence"),
    ("plain", "what-if --set uncertain.rate.sigma=0.9"),
    ("plain", "row 3"),
    ("plain", "trace outputs/life/quantiles/0.5"),
    ("plain", "verify"),
    ("units", "levels"),
    ("units", "fleet --size 2 --by 1e6"),
    ("units", "verify"),
]


@pytest.mark.parametrize("kind", KINDS)
def test_a_summary_of_version_one_has_the_same_numbers(kind, uq, folder):
    expected = json.loads((KEPT / f"{kind}.json").read_text())
    shutil.copy(KEPT / f"{kind}.nc", f"{kind}.nc")
    shown = json.loads(uq("summary", f"{kind}.nc", "--json").out)
    assert shown.pop("card")["rows"] == expected["answer"]["rows"]
    now, before = dict(leaves(shown)), dict(leaves(expected))
    assert now.keys() == before.keys()
    for path, value in before.items():  # other processors round otherwise
        is_number = isinstance(value, float)
        assert now[path] == (pytest.approx(value, rel=1e-12) if is_number else value), path


def leaves(tree, path=()):
    """Yield the path and the value of each leaf of a JSON document."""
    if not isinstance(tree, dict | list) or not tree:
        yield path, tree
        return
    for key, branch in tree.items() if isinstance(tree, dict) else enumerate(tree):
        yield from leaves(branch, (*path, key))


@pytest.mark.parametrize("kind", KINDS)
def test_rows_of_version_one_are_those_of_today(kind):
    with xr.open_dataset(KEPT / f"{kind}.nc", decode_timedelta=False) as old:
        assert old.attrs["schema_version"] == 1 and "sample" in old.dims
        new = api.open_result(KEPT / f"{kind}.nc")
        assert new.attrs["schema_version"] == 2
        assert new.sizes["row"] == old.sizes["sample"] and "sample" not in new.variables
        for name, variable in old.data_vars.items():
            assert np.array_equal(new[name].values, variable.values, equal_nan=True)
        assert api.summary(old).equals(api.summary(new))


@pytest.mark.parametrize("kind, command", VERBS)
def test_every_verb_reads_version_one(kind, command, uq, folder):
    verb, *options = command.split()
    shutil.copy(KEPT / f"{kind}.nc", "old.nc")
    ended = uq(verb, "old.nc", *options)
    assert (ended.code or 0, ended.err) == (0, "")


def test_a_result_of_version_one_is_extended(uq, folder):
    shutil.copy(KEPT / "plain.nc", "old.nc")
    before = api.open_result("old.nc")
    assert uq("extend", "old.nc", "--samples", "60", "--quiet").code == 0
    after = api.open_result("old.nc")
    assert after.sizes["row"] == 60
    assert np.array_equal(after["life"].values[:40], before["life"].values)
