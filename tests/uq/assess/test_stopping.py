"""A run that stops when it has seen enough, and intervals that stay honest for it."""

from dataclasses import replace

import numpy as np
import pytest
from computed import as_text, computed, study_of, summarised, with_seed
from until_studies import study, tables

import uq
from uq.assess import stopping
from uq.errors import InputError
from uq.execution import amending, clusters, row_folder, runner
from uq.execution.options import RunOptions
from uq.execution.row_folder import run_status
from uq.result.result import Result
from uq.result.result_file import open_result
from uq.result.workload import workload_of
from uq.study.definition import study_from_text


@pytest.mark.parametrize(
    ("method", "replicates"),
    [("monte-carlo", 1), ("monte-carlo", 3), ("halton", 8), ("saltelli", 8)],
)
@pytest.mark.parametrize("estimate", [{}, {"above": 7.0}, {"below": 4.0}, {"quantile": 0.5}])
def test_a_run_stops_at_the_first_look_that_knows_enough(tmp_path, method, replicates, estimate):
    samples = 4096 // replicates if method == "monte-carlo" else 512
    half_width = 0.3 if "quantile" in estimate else 0.1
    of = study(half_width, samples=samples, method=method, replicates=replicates, **estimate)
    ds = runner.run(of, tmp_path / "out.nc", workers=0)
    sizes, stopped = stopping.interim_sizes(of.design), ds.attrs["samples"]
    assert stopping.interim_estimate(of.design, Result(ds)).reached
    assert stopped < samples
    earlier = [computed(of.with_samples(size)) for size in sizes if size < stopped]
    assert not any(
        stopping.interim_estimate(of.design, Result(earlier_rows)).reached
        for earlier_rows in earlier
    )


def test_a_stopped_run_is_that_of_fewer_samples_to_the_bit(tmp_path):
    of = study(0.1, samples=500, settings={"fail_above": 0.995, "fail_how": "raise"})
    ds = runner.run(of, tmp_path / "out.nc", workers=0)
    fewer = workload_of(of.with_samples(int(ds.attrs["samples"])))
    assert ds.identical(runner.carry_out(fewer, RunOptions(workers=0)))
    example = ds["status"].attrs["example_raised"]
    assert int(example.removeprefix("row ").partition(":")[0]) >= 32  # after the first look
    assert open_result(tmp_path / "out.nc").identical(ds)


def test_a_budget_that_is_spent_is_said(tmp_path):
    of = study(1e-6, samples=100)
    ds = runner.run(of, tmp_path / "out.nc", workers=0)
    assert ds.attrs["samples"] == 100
    (note,) = summarised(ds)["notes"]
    assert "budget of 100 samples is spent" in note and "1e-06 was not reached" in note


def test_a_stopped_run_is_complete(folder):
    of = study(0.2)
    first = runner.run(of, "out.nc")
    assert first.attrs["samples"] < of.design.samples
    (note,) = summarised(first)["notes"]
    assert "mean of y is" in note and "97.06% at each" in note
    samples = (
        f"{size:,}".replace(",", " ") for size in (first.attrs["samples"], of.design.samples)
    )
    ended = "ended at {} of {} samples: required half-width of 0.2 reached".format(*samples)
    assert ended.replace("\u00a0", " ") in " ".join(str(uq.card(first)).split())
    again = runner.run(of, "out.nc", progress=pytest.fail)
    assert again.identical(first)


class Killed(BaseException):
    """Ends a run wherever it is."""


def killed_at(rows):
    def report(progress):
        if progress.done >= rows:
            raise Killed

    return report


def whole(path):
    return path.read_bytes()


@pytest.mark.parametrize(
    "design",
    [
        {},
        pytest.param(
            {"method": "saltelli", "replicates": 4, "samples": 512}, marks=pytest.mark.slow
        ),
        pytest.param(
            {"method": "saltelli", "replicates": 4, "samples": 512, "index": "ST"},
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_killed_run_that_goes_on_writes_the_same_file(folder, monkeypatch, design):
    of = study(0.1, **design)
    once = runner.run(of, "once.nc")
    total = once.sizes["row"]
    for place in ("chunk", "look", "cut"):
        path = folder / f"{place}.nc"
        with monkeypatch.context() as patch, pytest.raises(Killed):
            if place == "look":  # the rows of a look are all there, and nobody has looked
                patch.setattr(runner.stopping, "interim_estimate", raising)
            if place == "cut":  # enough is known and the file is not written
                patch.setattr(runner.disk_store.DiskStore, "dataset", raising)
            runner.run(of, path, progress=killed_at(total // 2) if place == "chunk" else None)
        status = run_status(path)
        assert status.state == "interrupted" or place == "cut"
        reports = []
        runner.run(of, path, progress=reports.append)
        assert reports[0].done == reports[0].reused == status.done > 0
        assert reports[-1].done == reports[-1].total == total
        assert whole(path) == whole(folder / "once.nc")
        assert run_status(path).state == "complete"
        assert not row_folder.folder_of(path).exists()


def raising(*arguments, **named):
    raise Killed


@pytest.mark.slow
def test_a_wish_for_more_goes_on_where_the_run_stopped(folder):
    first = runner.run(study(0.2), "out.nc")
    reports = []
    more = runner.run(study(0.1), "out.nc", progress=reports.append)
    assert more.attrs["samples"] > first.attrs["samples"] == reports[0].reused
    assert whole(folder / "out.nc") == whole_of(study(0.1), folder)


def whole_of(study, folder):
    runner.run(study, folder / "other.nc")
    return whole(folder / "other.nc")


@pytest.mark.slow
def test_extending_gives_as_many_as_are_asked_for_whatever_is_known(folder):
    of = study(0.2, samples=1000)
    stopped = runner.run(of, "out.nc").attrs["samples"]
    assert stopped == 500
    assert amending.extend(folder / "out.nc", 700).attrs["samples"] == 700
    (note,) = summarised(open_result(folder / "out.nc"))["notes"]
    assert "with the first 500 of 700 samples" in note
    again = runner.run(of, "out.nc", progress=pytest.fail)
    assert again.attrs["samples"] == 700
    amending.extend(folder / "out.nc", 1000)  # another look, and not the one it stopped at
    (note,) = summarised(open_result(folder / "out.nc"))["notes"]
    assert "with the first 500 of 1000 samples" in note


def test_a_new_description_changes_no_number_of_rows(folder):
    of = study(0.2)
    first = runner.run(of, "out.nc")
    named = replace(of, text=of.text + "\n# a remark\n")
    again = runner.run(named, "out.nc", progress=pytest.fail)
    assert again.attrs["study"] == named.text
    assert again.attrs["samples"] == first.attrs["samples"] == again.sizes["row"]


def test_the_budget_is_that_of_the_file(folder):
    with pytest.raises(InputError, match=r"samples = 100: .* at most .* its file, 4096"):
        runner.run(study(0.2).with_samples(100), "out.nc")
    assert list(folder.iterdir()) == []


@pytest.mark.slow
def test_workers_stay_from_look_to_look(folder, monkeypatch):
    started = []
    local = clusters.local_workers
    monkeypatch.setattr(
        clusters,
        "local_workers",
        lambda count, *more: started.append(count) or local(count, *more),
    )
    ds = runner.run(study(0.1), "out.nc", workers=2)
    assert started == [2]
    assert ds.attrs["samples"] > 32
    assert whole(folder / "out.nc") == whole_of(study(0.1), folder)


def test_a_lifetime_that_never_ends_and_failed_rows_do_not_stop_a_run_early(tmp_path):
    failing = study(10.0, samples=64, settings={"fail_above": -1.0})
    assert runner.run(failing, tmp_path / "failing.nc", workers=0).attrs["samples"] == 64
    wear = {"distribution": "lognormal", "median": 2.5e-10, "sigma": 0.5}
    table = tables({"output": "life", "half_width": 1e9}, samples=64)
    table |= {"uncertain": {"rate": wear}, "fixed": {"threshold": 2.5e-10}}
    endless = runner.run(study_of(table, "exponential-wear"), tmp_path / "wear.nc", workers=0)
    assert endless.attrs["samples"] == 64
    assert any("some rows never end" in note for note in summarised(endless)["notes"])


@pytest.mark.parametrize(
    ("until", "more", "words"),
    [
        ({"output": "z", "half_width": 0.1}, {}, r"\[design.until\] output = 'z'|no such output"),
        ({"output": "y", "half_width": 0.0}, {}, "half_width"),
        ({"output": "y"}, {}, "half_width"),
        ({"output": "y", "half_width": 1.0, "above": 1.0, "quantile": 0.5}, {}, "at most one of"),
        ({"output": "y", "half_width": 1.0}, {"method": "latin-hypercube"}, "cannot grow"),
        ({"output": "y", "half_width": 1.0}, {"method": "halton"}, "set replicates = 8"),
    ],
)
def test_mistakes_are_refused_with_the_study(until, more, words):
    with pytest.raises(InputError, match=words) as refused:
        study_from_text(as_text(tables(until, **more)))
    assert len(refused.value.lines) == 1


def test_until_is_no_part_of_a_studys_identity():
    assert study(0.1).identity == study(0.2, above=3.0).identity


@pytest.mark.slow
@pytest.mark.parametrize(
    ("estimate", "half_width", "truth"), [({}, 0.2, 5.0), ({"above": 9.0}, 0.005, 1 / 576)]
)
def test_intervals_stay_honest_under_stopping(estimate, half_width, truth):
    of = study(half_width, samples=2048, **estimate)
    held, stopped = [], []
    for seed in range(300):
        seeded = with_seed(of, seed)
        ds = computed(seeded)
        for size in stopping.interim_sizes(seeded.design):
            seen = stopping.interim_estimate(seeded.design, Result(ds.isel(row=slice(size))))
            if seen.reached:
                break
        low, high = seen.estimate.numbers[1:]
        held.append(low <= truth <= high)
        stopped.append(size)
    print(f"\n{estimate or 'mean'}: {np.mean(held):.1%}, {np.mean(stopped):.0f} samples")
    assert np.mean(held) >= 0.94
    assert len(set(stopped)) > 1
