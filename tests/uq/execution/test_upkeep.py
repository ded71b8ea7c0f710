"""A result can be extended, its failed rows run again, and all of it be verified."""

import json
import re
import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest
from wordings import sentence

import uq as api
from uq.contract import Status
from uq.execution import child
from uq.files.netcdf_files import seal

RAISING = '[settings]\nfail_above = 0.5\nfail_how = "raise"\n[analysis]\nmax_failed = 1.0'

QUIETLY = ("--quiet", "--workers", 0)
"""Without a process of its own: nothing here depends on who computes."""


@pytest.fixture
def result(uq, write_study):
    """Make a result some of whose rows failed."""
    path = write_study(model="linear", samples=200, uncertain=("x1", "x2"), more=RAISING)
    assert uq("run", path, "-o", "out.nc", *QUIETLY).code == 0
    return path


@pytest.mark.parametrize(
    "design",
    [
        {"method": "monte-carlo", "samples": 50, "replicates": 2},
        {"method": "sobol", "samples": 32},
        {"method": "halton", "samples": 30},
        {"method": "saltelli", "samples": 16, "replicates": 2},
    ],
    ids=lambda design: design["method"],
)
def test_extended_is_the_same_as_asked_for_at_once(uq, write_study, design):
    path = write_study(model="linear", more=RAISING, **design)
    more = 2 * design["samples"]
    uq("run", path, "-o", "out.nc", *QUIETLY)
    assert uq("extend", "out.nc", "--samples", more, *QUIETLY) == (0, "", "")
    uq("run", path, "-o", "once.nc", "--samples", more, *QUIETLY)
    assert Path("out.nc").read_bytes() == Path("once.nc").read_bytes()


def test_what_cannot_be_extended_says_why(uq, write_study):
    uq("run", write_study(method="latin-hypercube"), "-o", "out.nc", *QUIETLY)
    before = Path("out.nc").read_bytes()
    ended = uq("extend", "out.nc", "--samples", 128)
    assert ended.code == 2
    assert ended.err == "out.nc: " + sentence("cannot be extended", design="latin-hypercube")
    fewer = uq("extend", "out.nc", "--samples", 32)
    assert fewer.code == 2 and fewer.err.startswith("samples = 32: out.nc has 64 ")
    assert uq("extend", "none.nc", "--samples", 32).err.startswith(
        sentence("no file", name="none.nc")
    )
    assert Path("out.nc").read_bytes() == before


def test_a_grown_study_extends_its_result(uq, write_study):
    uq("run", write_study(samples=40), "-o", "out.nc", *QUIETLY)
    path = write_study(samples=100)
    ended = uq("run", path, "-o", "out.nc")
    assert ended.err == sentence("done", output="out.nc", done=40, rows=100)
    words = " ".join(ended.out.split())
    assert re.search(r"out.nc: 60 rows computed in [0-9.]+ s; 40 computed before", words)
    uq("run", path, "-o", "once.nc", *QUIETLY)
    assert Path("out.nc").read_bytes() == Path("once.nc").read_bytes()


def test_failed_rows_are_run_again_with_changed_settings(uq, result):
    before = api.open_result("out.nc")
    failed = before["status"].values == Status.RAISED
    assert 0 < failed.sum() < 200
    ended = uq("rerun", "out.nc", "--failed", "--setting", "fail_above=0.7")
    assert ended.code == 0
    after = api.open_result("out.nc")
    assert np.array_equal(after["rerun"].values, failed)
    assert after["rerun"].attrs["changed_1"] == "{fail_above = 0.7}"
    still = after["x1"].values > 0.7
    assert np.array_equal(after["status"].values == Status.RAISED, still)
    assert np.array_equal(after["y"].values[~failed], before["y"].values[~failed])
    expected = after["x1"] + 2 * after["x2"] + 3 * 0.5 + 4 * 0.5
    assert np.allclose(after["y"].values[~still], expected.values[~still], rtol=1e-14)
    assert uq("verify", "out.nc").code == 0
    assert uq("rerun", "out.nc", "--failed", "--setting", "fail_above=2.0", *QUIETLY).code == 0
    last = api.open_result("out.nc")
    settings = {"no": "no"} | {f"changed-{i}": last["rerun"].attrs[f"changed_{i}"] for i in (1, 2)}
    labels = np.array(last["rerun"].attrs["flag_meanings"].split())[last["rerun"].values]
    assert np.array_equal(
        [settings[label] for label in labels],
        np.where(still, "{fail_above = 2.0}", np.where(failed, "{fail_above = 0.7}", "no")),
    )
    assert (last["status"] == Status.OK).all()
    assert uq("verify", "out.nc").code == 0
    assert "no row is invalid" in uq("rerun", "out.nc", "--failed").err
    assert uq("extend", "out.nc", "--samples", 300, *QUIETLY).code == 0
    assert np.array_equal(api.open_result("out.nc")["rerun"].values[:200], last["rerun"].values)


@pytest.mark.slow
def test_endless_rows_are_stopped_when_extending_and_running_again(uq, write_study, monkeypatch):
    monkeypatch.setattr(child, "FIRST_SECONDS", 0.5)
    more = '[settings]\nfail_above = 0.85\nfail_how = "hang"'
    path = write_study(model="linear", samples=12, uncertain=("x1",), more=more)
    assert uq("run", path, "-o", "out.nc", "--quiet").code == 0
    limit = ("--row-limit", "0.5", "--quiet")
    assert uq("extend", "out.nc", "--samples", 24, *limit).code == 0
    after = api.open_result("out.nc")
    assert np.array_equal(after["status"].values == Status.TIMED_OUT, after["x1"].values > 0.85)
    assert (after["status"] == Status.TIMED_OUT).sum() == 1
    assert uq("rerun", "out.nc", "--failed", *limit).code == 0
    assert api.open_result("out.nc").identical(after)


def test_failed_rows_run_again_as_they_were_change_no_bit(uq, result):
    before = Path("out.nc").read_bytes()
    assert uq("rerun", "out.nc", "--failed", *QUIETLY).code == 0
    assert Path("out.nc").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), "uq rerun: add --failed: it recomputes the invalid rows\n"),
        (("--failed", "--setting", "fail_abov=1"), "setting fail_abov = 1: no such setting of"),
        (("--failed", "--setting", "fail_how=no"), "setting fail_how = 'no': must be one of"),
    ],
)
def test_a_rerun_that_makes_no_sense_is_refused(uq, result, arguments, words):
    ended = uq("rerun", "out.nc", *arguments)
    assert (ended.code, ended.out) == (2, "")
    assert ended.err.startswith(words)
    assert ended.err.count("\n") == 1
    assert not Path("out.nc.rows").exists()


def test_status_of_a_complete_result(uq, result):
    shown = uq("status", "out.nc")
    assert shown.code == 0
    assert "out.nc: complete" in shown.out
    status = json.loads(uq("status", "out.nc", "--json").out)
    failed = status["failed"]
    assert 0 < failed < 200
    assert status == {
        "output": "out.nc",
        "state": "complete",
        "rows": 200,
        "done": 200,
        "failed": failed,
        "left": 0,
        "status": {"ok": 200 - failed, "raised": failed},
        "rate": None,
        "seconds_left": None,
        "process": None,
        "complete_rows": 200,
    }
    none = uq("status", "none.nc")
    assert (none.code, none.out) == (2, "")
    assert none.err.startswith(sentence("no file", name="none.nc"))


def test_verify_finds_a_flipped_bit_wherever_it_is(uq, result):
    sound = uq("verify", "out.nc")
    assert sound.code == 0
    assert "checksum  right" in sound.out
    assert "16 of 16 recomputed are equal to the bit" in sound.out
    content = Path("out.nc").read_bytes()
    values = api.open_result("out.nc")["y"].values.tobytes()
    for wanted in (values, b"uniform"):  # an output, and the text of the study
        place = content.index(wanted) + len(wanted) // 2
        Path("out.nc").write_bytes(
            content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]
        )
        flipped = uq("verify", "out.nc")
        assert flipped.code != 0
        assert "checksum  WRONG" in flipped.out or "not a readable" in flipped.err


@pytest.mark.parametrize("variable", ["", "y"])
def test_verify_finds_words_that_were_changed(uq, write_study, variable):
    uq("run", write_study(samples=12), "-o", "out.nc", *QUIETLY)
    with netCDF4.Dataset("out.nc", "a") as file:
        owner = file[variable] if variable else file
        owner.setncattr("source" if owner is file else "units", "else")
    ended = uq("verify", "out.nc")
    assert ended.code == 1
    assert "checksum  WRONG" in ended.out


def test_verify_finds_rows_that_would_come_out_otherwise_and_names_versions(uq, write_study):
    uq("run", write_study(samples=12), "-o", "out.nc", *QUIETLY)
    with netCDF4.Dataset("out.nc", "a") as file:
        file["y"][3] += 1e-12
        file.setncattr("numpy", "0.9")
    ended = uq("verify", "out.nc")
    assert ended.code == 1
    assert "checksum  WRONG" in ended.out
    assert "numpy  0.9 made it, " in ended.out
    assert "recomputed, differs in row 3: y" in ended.out
    assert "11 of 12 recomputed are equal to the bit" in ended.out


@pytest.mark.parametrize(("change", "code"), [(1e-15, 0), (1e-9, 1)])
def test_another_processor_may_round_otherwise_and_no_more(uq, write_study, change, code):
    uq("run", write_study(samples=12), "-o", "out.nc", *QUIETLY)
    shutil.copy("out.nc", "other.nc")
    for name in ("out.nc", "other.nc"):
        with netCDF4.Dataset(name, "a") as file:
            file["y"][3] *= 1 + change
            if name == "other.nc":
                file.setncattr("cpu", "another")
        seal(Path(name))
    same, other = uq("verify", "out.nc"), uq("verify", "other.nc")
    assert (same.code, other.code) == (1, code)
    assert "keeps state" in same.out and "keeps state" not in other.out
    assert ("rounds otherwise" in other.out) == (code == 0)
    assert "cpu  another made it" in other.out


def test_a_result_of_another_version_of_the_model_is_not_taken_for_this_one(uq, write_study):
    uq("run", write_study(samples=12), "-o", "out.nc", *QUIETLY)
    with netCDF4.Dataset("out.nc", "a") as file:
        file.setncattr("model_version", "0")
        file.setncattr("study_identity", "0" * 64)
    for verb in (("verify", "out.nc"), ("extend", "out.nc", "--samples", 20)):
        ended = uq(*verb)
        assert ended.code == 2
        versions = {"model": "ishigami", "old": 0, "new": 1}
        assert ended.err == sentence("another model", output="out.nc", **versions)


def test_a_result_of_other_code_goes_further_on_request_alone(uq, write_study):
    uq("run", write_study(samples=12), "-o", "out.nc", *QUIETLY)
    with netCDF4.Dataset("out.nc", "a") as file:
        file.setncattr("code", "0")
    verb = ("extend", "out.nc", "--samples", 20)
    refused = uq(*verb)
    assert refused.code == 2
    assert refused.err == sentence("other code refused", output="out.nc", model="ishigami")
    assert uq(*verb, "--mixed").code == 0
    assert api.open_result("out.nc").attrs["code"].startswith("0; ")


def test_rows_of_other_versions_are_named_in_the_result(uq, write_study):
    uq("run", write_study(samples=12), "-o", "out.nc", *QUIETLY)
    with netCDF4.Dataset("out.nc", "a") as file:
        file.setncattr("numpy", "0.9")
    ended = uq("extend", "out.nc", "--samples", 20)
    assert ended.code == 0
    versions = {"package": "numpy", "old": "0.9", "new": np.__version__}
    assert ended.err == sentence("done", output="out.nc", done=12, rows=20) + sentence(
        "other versions", output="out.nc", **versions
    )
    assert api.open_result("out.nc").attrs["numpy"] == f"0.9; {np.__version__}"
