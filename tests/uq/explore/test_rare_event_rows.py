"""Rare events: rows without a value, and who computes them."""

import numpy as np
import pytest
from computed import UNIFORM, as_text, with_seed
from rare_studies import LAST, WEAR, branches, close, linear, study
from scipy import stats

from uq.errors import InputError
from uq.explore.rare_events import rare_event


@pytest.mark.parametrize(
    "how", ["nan", *(pytest.param(how, marks=pytest.mark.slow) for how in ("raise", "shape"))]
)
def test_failed_rows_count_as_outside_and_are_said(how):
    of = linear(settings={"fail_above": 0.97, "fail_how": how})
    ds = rare_event(of, "y", 9.0, samples=500)
    # Given x1, the shortfalls of the others must stay below it: x1^3/144.
    truth = 0.97**4 / (4 * 144)
    assert close(ds, truth)
    assert 0 < int(ds["failed"]) < int(ds["rows"])
    assert f"{int(ds['failed'])} of {int(ds['rows'])} rows" in ds.attrs["notes"]
    with pytest.raises(InputError, match="use method 'subset'"):
        rare_event(linear(settings={"fail_above": 1e-4}), "y", 9.0, method="importance")


def test_lifetimes_that_never_end_lie_above_everything():
    of = study("exponential-wear", WEAR, fixed={"threshold": 2.5e-10})
    ds = rare_event(of, "life", 1e9)
    assert close(ds, 0.5)
    # Most rows never end: the event lies in what is left of them.
    of = study("exponential-wear", WEAR, fixed={"threshold": 1e-9})
    rate = stats.lognorm(s=0.5, scale=2.5e-10)
    nodes = stats.lognorm(s=0.2, scale=2.5e-4).ppf((np.arange(100_000) + 0.5) / 100_000)
    truth = rate.sf(np.maximum(nodes / 1e5, 1e-9)).mean()
    ds = rare_event(of, "life", 1e5, below=True)
    assert close(ds, truth)


def test_undefined_and_censored_rows_lie_on_neither_side():
    of = study("sample_models:KINDS", {"x1": UNIFORM, "x2": UNIFORM})
    ds = rare_event(of, "angle", 0.99)
    assert close(ds, 0.01)
    assert int(ds["undefined"]) > 0 and "neither side" in ds.attrs["notes"]
    name = "life[side=left,depth=0.5]"
    ds = rare_event(of, name, 1.2, below=False)  # never below x1 = 0.2, x1 + 0.5 > 1.2 else
    assert close(ds, 0.5)
    ds = rare_event(of, name, 1.45)  # rows beyond x1 = 0.8 were censored before 1.45
    assert int(ds["failed"]) > 0 and "censored" in ds.attrs["notes"]


@pytest.mark.parametrize(
    ("of", "output", "threshold"),
    [
        (linear(), "y", 10.5),
        pytest.param(branches(), "turn", 90.0, marks=pytest.mark.slow),
    ],
)
def test_a_threshold_out_of_reach_is_bounded_by_the_levels_that_were_reached(of, output, threshold):
    ds = rare_event(of, output, threshold, samples=200, replicates=2)
    assert float(ds["probability"]) == float(ds["low"]) == 0
    assert set(ds["ended"].values) <= {"smallest", "plateau"}
    assert 0 < float(ds["high"]) < 0.01
    assert f"below {float(ds['high']):.2g}" in ds.attrs["notes"]


def test_all_rows_failed_is_no_event():
    ds = rare_event(linear(settings={"fail_above": -1.0}), "y", 9.0, samples=200, replicates=2)
    assert float(ds["probability"]) == 0 and int(ds["failed"]) == int(ds["rows"]) == 400


def test_failed_rows_within_the_event_have_a_bound_of_their_own():
    ds = rare_event(linear(settings={"fail_above": 0.97}), "y", 9.0, samples=500)
    # 3 % of the independent rows failed.
    assert 0.025 < float(ds["failed_high"]) < 0.04
    assert f"no more than {float(ds['failed_high']):.2g}" in ds.attrs["notes"]
    assert np.isnan(rare_event(linear(), "y", 9.0, samples=500)["failed_high"])


@pytest.mark.slow
def test_rows_that_kill_their_process_are_failed_rows():
    of = linear(settings={"fail_above": 0.98, "fail_how": "exit"})
    ds = rare_event(of, "y", 1.0, below=True, samples=100, replicates=1)
    assert ds["failed"] > 0 and ds["probability"] > 0
    assert "killed its process" in ds.attrs["notes"]


def test_imported_rows_have_no_laws_to_draw_from(folder):
    (folder / "rows.csv").write_text("x1,x2\n" + "0.5,0.5\n" * 64)
    tables = {
        "study": {"name": "imported", "model": "linear"},
        "design": {"method": "imported", "samples": 64, "file": "rows.csv"},
        "uncertain": {"x1": UNIFORM, "x2": UNIFORM},
    }
    (folder / "study.toml").write_text(as_text(tables))
    with pytest.raises(InputError, match=r"study.toml: \[design\] method = 'imported'") as refused:
        rare_event("study.toml", "y", LAST)
    assert len(refused.value.lines) == 1


@pytest.mark.slow
def test_workers_change_no_bit():
    here, there = (
        rare_event(linear(), "y", LAST, samples=200, replicates=2, workers=workers)
        for workers in (0, 2)
    )
    assert here.identical(there)


def test_the_seed_of_the_study_decides():
    first, same, other = (
        rare_event(of, "y", 9.0, samples=100, replicates=1)
        for of in (linear(), linear(), with_seed(linear(), 4))
    )
    assert first.identical(same)
    assert not np.array_equal(first["estimate"], other["estimate"])


def test_random_numbers_of_a_model_are_part_of_the_event():
    # work = x1 + up to 6e-3 from the row's own seed: beyond 1.005 only by both.
    of = study("sample_models:KINDS", {"x1": UNIFORM, "x2": UNIFORM})
    ds = rare_event(of, "work[side=right]", 1.0)
    truth = np.mean(np.arange(7) * 1e-3)
    assert close(ds, truth)
