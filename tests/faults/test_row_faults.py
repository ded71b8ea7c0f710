"""A row that raises, hangs or takes its process with it gets its status and harms no other row."""

import time

import numpy as np
import pytest
from faulty_studies import FAULTY, computed_here
from in_memory import compute
from wordings import sentence

from uq.contract import Status
from uq.errors import InputError
from uq.execution import child, isolation
from uq.study.evaluate import KernelError

FAULTS = {
    "raise": ("linear", {"fail_how": "raise"}, Status.RAISED, "x1 is above"),
    "nan": ("linear", {"fail_how": "nan"}, Status.NON_FINITE, "'y' is nan"),
    "inf": ("linear", {"fail_how": "inf"}, Status.NON_FINITE, "'y' is inf"),
    "shape": ("linear", {"fail_how": "shape"}, Status.BAD_SHAPE, "'y' has shape"),
    "exit": ("linear", {"fail_how": "exit"}, Status.CRASHED, "exit code 1"),
    "hang": ("linear", {"fail_how": "hang"}, Status.TIMED_OUT, "did not end within 0.5 s"),
    "segfault": (FAULTY, {"how": "segfault"}, Status.CRASHED, "Segmentation fault"),
    "killed": (FAULTY, {"how": "kill"}, Status.CRASHED, "Killed"),
}
QUICK = ("raise", "nan", "shape", "segfault", "hang")
"""One of each status."""


@pytest.mark.parametrize(
    ("fault", "workers"),
    [
        pytest.param(
            fault, workers, marks=[pytest.mark.slow] * (workers == 2 or fault not in QUICK)
        )
        for fault in FAULTS
        for workers in (None, 2)
    ],
)
def test_guilty_rows_get_their_status_and_the_others_their_values(
    study_of, monkeypatch, injected, fault, workers
):
    monkeypatch.setattr(child, "FIRST_SECONDS", 0.5)
    model, settings, status, words = FAULTS[fault]
    key = "fail_above" if model == "linear" else "above"
    study = study_of(model, samples=100, **settings, **{key: 0.98})
    ds = compute(study, workers=workers, row_limit=0.5 if fault == "hang" else None, chunk_rows=30)
    guilty = ds["x1"].values > 0.98
    assert 0 < guilty.sum() < 5
    injected(f"row: {fault}", guilty.sum())
    assert np.array_equal(ds["status"].values, np.where(guilty, status, Status.OK))
    first = np.flatnonzero(guilty)[0]
    example = ds["status"].attrs[f"example_{status.name.lower()}"]
    assert example.startswith(f"row {first}: ")
    assert words in example
    sound = computed_here(study_of(model, samples=100))
    assert np.array_equal(ds["y"].values[~guilty], sound["y"].values[~guilty])
    assert np.isnan(ds["y"].values[guilty]).all()


def test_a_wrong_dtype_refuses_the_model(study_of, injected):
    study = study_of(above=0.98, how="dtype")
    for workers in (0, 1):
        injected("row: dtype")
        with pytest.raises(KernelError, match="'y' is float32, expected float64"):
            compute(study, workers=workers, chunk_rows=10)


@pytest.mark.slow
def test_compiling_is_no_part_of_the_time_of_a_row(study_of, monkeypatch):
    monkeypatch.setattr(child, "FIRST_SECONDS", 0.0)
    seconds = []
    real = isolation.Isolated._answer

    def timed(self, connection, limit):
        began = time.monotonic()
        answer = real(self, connection, limit)
        seconds.append(time.monotonic() - began)
        return answer

    monkeypatch.setattr(isolation.Isolated, "_answer", timed)
    ds = compute(study_of("faulty_models:COMPILING", samples=1), row_limit=1.0)
    assert ds["status"].values.tolist() == [Status.OK]
    assert max(seconds) > 1.0  # or this shows nothing


def test_a_time_limit_needs_a_process_to_stop(uq, study_of):
    study = study_of()
    with pytest.raises(InputError, match="needs another process"):
        compute(study, workers=0, row_limit=1.0)
    with pytest.raises(InputError, match="must be positive"):
        compute(study, row_limit=0.0)
    ended = uq("run", study.path, "--model", FAULTY, "--workers", 0, "--row-limit", 1)
    assert (ended.code, ended.err.count("\n")) == (2, 1)


def test_too_many_failed_rows_are_an_exit_code_after_the_result(uq, study_of, folder):
    study = study_of("linear", samples=4, fail_how="exit", fail_above=0.6)
    ended = uq("run", study.path, "--workers", 1)
    assert ended.code == 1
    assert "crashed" in ended.out
    assert sentence("too many failed", share=0.1, status="crashed") in ended.err
    assert (folder / "results" / "small.nc").exists()
